"""``wildscav watch`` and ``wildscav replay --html``."""

import os
import re
import shutil
import signal
import socket
from collections.abc import Callable
from functools import partial
from pathlib import Path
from urllib.request import ProxyHandler, build_opener

import pytest
from starlette.testclient import TestClient
from tests.commands import Run, run_command, running
from tests.platform.stage.built_viewer import viewer

from wildscav_inspect import records
from wildscav_stage.watching.match_page import scene_of, whole_page

__all__ = ["viewer"]
END = 120  # s, far more than it takes


@pytest.fixture
def record(record: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(record, tmp_path / "match.wsr"))


@pytest.fixture
def run(tmp_path: Path) -> Run:
    return partial(run_command, cwd=tmp_path, columns=200)


def test_it_serves_the_match_until_ctrl_c(record: Path) -> None:
    """With the viewer that is built: a process has no other."""
    until = r"^watch at (http://127\.0\.0\.1:\d+/)\n"
    with running("watch", record, "--no-browser", until=until) as (link, process):
        with build_opener(ProxyHandler({})).open(link) as answer:
            page = answer.read().decode()
        process.send_signal(signal.SIGINT)
        assert process.wait(END) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""

    assert "data-match" in page
    assert re.search(r'src="/stage/viewer\.js\?v=\w+"', page)


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["watch", "none.wsr"], 1, "none.wsr: cannot be read: No such file or directory"),
        (["watch", "empty"], 1, "empty: there are no records"),
        (["watch", "match.wsr", "--season", "https://example.org"], 2, "--season is for the number"),
        (["replay", "none.wsr", "--html"], 1, "none.wsr: cannot be read: No such file or directory"),
        (["replay", "broken.wsr", "--html"], 1, "broken.wsr"),
        (["replay", "match.wsr", "--html", "-o", "page.txt"], 2, "must end in .html"),
        (["replay", "match.wsr", "-o", "none/page.html"], 1, "page.html: No such file or directory"),
        (["replay", "linked.html", "--html"], 2, "is the record itself"),
        (["replay", "match.wsr", "--html", "--web"], 2, "no other options"),
        (["replay", "match.wsr", "--html", "--seat", "1"], 2, "no other options"),
        (["replay", "match.wsr", "--html", "--port", "80"], 2, "no other options"),
        (["replay", ".", "--html"], 2, ". is a folder"),
        (["replay", "match.wsr", "--scene", "pages", "--html"], 2, "--scene takes --season"),
        (["replay", "none.wsr", "--scene", "pages"], 1, "none.wsr: cannot be read: No such file or"),
        (["replay", "match.wsr", "--scene", "match.wsr"], 1, "cannot make match.wsr: File exists"),
        (["watch", "match.wsr", "--with", "empty"], 2, "empty is a folder: name one of its records"),
        (["watch", "match.wsr", "--with", "none.wsr"], 1, "none.wsr: cannot be read: No such file or"),
        (["watch", "https://example.org/matches/3", "--season", "https://example.org"], 2, "names one"),
        (["replay", "match.wsr", "-o", "page.html", "--view", "behind"], 2, "no other options"),
    ],
)
@pytest.mark.usefixtures("viewer")
def test_what_cannot_be_done_is_one_clear_line(
    run: Run, record: Path, arguments: list[str], code: int, message: str
) -> None:
    folder = record.parent
    (folder / "empty").mkdir()
    (folder / "broken.wsr").write_bytes(b"nothing")
    (folder / "linked.html").hardlink_to(record)

    done = run(*arguments)

    assert done.returncode == code, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(folder.glob("*page*"))


@pytest.mark.parametrize("more", ["", "/", "/watch", "#t=3.5&seat=1", "/video"])
def test_the_page_of_a_match_names_its_season_and_its_number(
    monkeypatch: pytest.MonkeyPatch, more: str
) -> None:
    asked: list[tuple[int, str | None]] = []

    class Source:
        def load(self) -> Callable[[int, str | None], Path]:
            return lambda match, season: (asked.append((match, season)), Path("it.wsr"))[1]

    monkeypatch.setattr(records, "entry_points", lambda group: [Source()])

    assert records.resolve_record(Path(f"https://a.example:81/s/matches/12{more}"), None) == Path("it.wsr")
    assert asked == [(12, "https://a.example:81/s")]


@pytest.mark.usefixtures("viewer")
def test_latest_is_the_newest_record_or_the_evaluation_that_it_is_of(
    run: Run, record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    watched: list[list[Path]] = []
    monkeypatch.setattr(
        "wildscav_stage.watching.match_site.match_site", lambda _, records, *__: watched.append(records)
    )
    monkeypatch.setattr("wildscav_stage.watching.match_site.serve", lambda _, listening: listening.close())
    evaluation = record.parent / "out" / "evaluation" / "records"
    evaluation.mkdir(parents=True)
    for number, name in enumerate(["0.wsr", "1.wsr"]):
        shutil.copy(record, evaluation / name)
        os.utime(evaluation / name, (number, number))

    for _ in range(2):
        assert run("watch", "latest", "--no-browser").returncode == 0
        os.utime(evaluation / "0.wsr", (2e9, 2e9))

    assert watched == [
        [Path("match.wsr")],
        [Path("out/evaluation/records") / name for name in ("0.wsr", "1.wsr")],
    ]


def test_the_two_files_of_a_scene_are_written(run: Run, record: Path) -> None:
    done = run("replay", record, "--scene", "of/it")

    assert done.returncode == 0, done.stderr
    scene = scene_of(record)
    assert (record.parent / "of/it/map.gz").read_bytes() == scene.map
    assert (record.parent / "of/it/match.json.gz").read_bytes() == scene.trails


@pytest.mark.usefixtures("viewer")
def test_two_records_are_compared_on_one_page(
    run: Run, record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    served: list[str] = []
    monkeypatch.setattr(
        "wildscav_stage.watching.match_site.serve",
        lambda site, listening: (
            served.append(TestClient(site, "http://127.0.0.1").get("/matches/0?with=1").text),
            listening.close(),
        ),
    )
    done = run("watch", record, "--with", shutil.copy(record, record.parent / "other.wsr"), "--no-browser")

    assert done.stdout.splitlines()[0].endswith("/matches/0?with=1")
    assert re.findall(r'data-map="([^"]+)"', served[0]) == ["/matches/0/map", "/matches/1/map"]


@pytest.mark.usefixtures("viewer")
def test_a_port_that_is_taken_is_said(run: Run, record: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = run("watch", record, "--no-browser", "--port", port)

    assert (done.returncode, done.stdout) == (1, "")
    said = f"port {port} of 127.0.0.1 cannot be used: Address already in use; choose another with --port"
    assert said in " ".join(done.stderr.split())


@pytest.mark.parametrize(
    ("options", "name"), [(["--html"], "match.html"), (["-o", "page.html"], "page.html")]
)
@pytest.mark.usefixtures("viewer")
def test_a_page_is_written(run: Run, record: Path, options: list[str], name: str) -> None:
    done = run("replay", record, *options)

    assert done.returncode == 0, done.stderr
    assert name in done.stdout
    assert (record.parent / name).read_text("utf-8") == whole_page(scene_of(record))


def test_a_viewer_that_is_not_built_is_said(run: Run, record: Path, viewer: Path) -> None:
    (viewer / "viewer.js").unlink()
    for arguments in (["watch", record, "--no-browser"], ["replay", record, "--html"]):
        done = run(*arguments)
        assert (done.returncode, done.stdout) == (1, "")
        assert "run make viewer in the checkout" in done.stderr
