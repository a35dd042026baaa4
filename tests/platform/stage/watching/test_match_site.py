"""The site of recorded matches: of one, and of several."""

import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from tests.leaderboard.spectating.served import served

from wildscav_stage.headers import HEADERS
from wildscav_stage.viewer_files import viewer_addresses
from wildscav_stage.watching.match_page import scene_of
from wildscav_stage.watching.match_site import match_site

Records = Callable[[str], Path]


@contextmanager
def client_of(records: Sequence[Path], title: str = "") -> Iterator[httpx.Client]:
    with (
        served(match_site(title, records)) as address,
        httpx.Client(base_url=address, timeout=60.0) as client,
    ):
        yield client


pytestmark = pytest.mark.usefixtures("viewer")


def test_the_first_page_of_one_record_is_its_match(record_of_track: Records) -> None:
    record = record_of_track("battle")
    scene = scene_of(record)

    with client_of([record]) as client:
        page = client.get("/").text
        assert 'data-map="/matches/0/map" data-trails="/matches/0/trails"' in page
        assert client.get("/matches/0").text == page
        for name, content in (("map", scene.map), ("trails", scene.trails)):
            with client.stream("GET", f"/matches/0/{name}") as answer:
                assert b"".join(answer.iter_raw()) == content
                assert answer.headers["Content-Encoding"] == "gzip"


@pytest.mark.parametrize(("asked", "status"), [("1", 200), ("2", 404), ("-1", 404), ("one", 404)])
def test_two_of_its_matches_are_compared(record_of_track: Records, asked: str, status: int) -> None:
    with client_of([record_of_track("battle"), record_of_track("navigation")]) as client:
        answer = client.get(f"/matches/0?with={asked}")
    assert answer.status_code == status
    assert (answer.text.count("data-match ") == 2) is (status == 200)


def test_of_several_records_each_has_its_match(record_of_track: Records, tmp_path: Path) -> None:
    broken = tmp_path / "broken.wsr"
    broken.write_bytes(b"nothing")
    records = [record_of_track("battle"), broken, record_of_track("navigation")]

    with client_of(records, "Matches of out") as client:
        first = client.get("/").text
        second, third = (client.get(f"/matches/{number}") for number in (1, 2))
        failed = client.get("/matches/1/map")

    for number, record in enumerate(records):
        assert f'<a href="/matches/{number}">{record.stem}</a>' in first
    assert "data-match" not in first
    assert "Navigation" in third.text
    assert (failed.status_code, "broken.wsr" in failed.json()["error"]) == (500, True)
    assert (second.status_code, "broken.wsr" in second.text, "data-match" in second.text) == (
        500,
        True,
        False,
    )


@pytest.mark.parametrize(
    "path", ["/matches/1", "/matches/1/map", "/matches/-1", "/matches/x", "/nothing", "/static/../app.py"]
)
def test_there_is_nothing_else_and_every_answer_has_the_headers(record_of_track: Records, path: str) -> None:
    with client_of([record_of_track("battle")]) as client:
        for asked, status in ((path, 404), ("/", 200), ("/matches/0/map", 200), ("/static/match.css", 200)):
            answer = client.get(asked)
            assert answer.status_code == status, asked
            assert {name: answer.headers[name] for name in HEADERS} == HEADERS


def test_a_page_of_a_list_does_not_wait_for_its_match(
    record_of_track: Records, monkeypatch: pytest.MonkeyPatch
) -> None:
    records = [record_of_track("battle"), record_of_track("navigation")]
    titles = [scene_of(record).title for record in records]
    monkeypatch.setattr("wildscav_stage.watching.match_site.scene_of", None)

    with client_of(records) as client:
        for number, title in enumerate(titles):
            assert f"<h1>{title}</h1>" in client.get(f"/matches/{number}").text


def test_browsers_keep_the_viewer(record_of_track: Records) -> None:
    with client_of([record_of_track("battle")]) as client:
        assert "immutable" in client.get(viewer_addresses()[0]).headers["Cache-Control"]


def test_only_names_of_this_machine_lead_to_it(record_of_track: Records) -> None:
    """Another name could be led here by whoever owns it, to read the matches with a page of its own."""
    own = ("127.0.0.1:80", "[::1]:80", "localhost", "LOCALHOST:1", "10.0.0.7", socket.gethostname())
    others = ("evil.example", "127.0.0.1.evil.example:80", "localhost.evil.example", "", "[")
    with client_of([record_of_track("battle")]) as client:
        for hosts, status in ((own, 200), (others, 400)):
            for host in hosts:
                answer = client.get("/static/match.css", headers={"Host": host})
                assert answer.status_code == status, host
