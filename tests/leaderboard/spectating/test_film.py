"""The video of a match on its page: made on first request, played and downloaded in a real browser."""

import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.responses import Response
from tests.browsers import DESK, chromium
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import Site, serving_filled
from tests.leaderboard.spectating.served import served
from tests.recorded_matches import SMALL_MAP

from wildscav.notes import note_line
from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.api.matches import file_response
from wildscav_leaderboard.spectating.render import LONGEST, pace_of, public_notes
from wildscav_leaderboard.spectating.render_cache import QUIET, RenderCache

PATIENCE = 120.0  # s, on a busy machine


@pytest.fixture(scope="module")
def site(
    new_filled_season: Callable[..., FilledSeason], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Site]:
    """A season all of whose matches have the record of the same two seconds."""
    match = Match(
        MatchSpec(track="battle", map=SMALL_MAP, seats=("fighter", "fighter"), time_limit=2.0, seed=3)
    )
    match.play_out()
    record = tmp_path_factory.mktemp("filmed") / "match.wsr"
    write_record(record, match, ["night-owl", "fighter"])
    filled = new_filled_season()
    filled.give_records(record.read_bytes())
    with serving_filled(filled) as one:
        yield one


@pytest.mark.slow
def test_a_visitor_has_the_video_made_watches_it_and_finds_it_again(site: Site) -> None:
    number = site.filled.matches["ladder"]
    address = f"{site.client.base_url}/matches/{number}".replace("//matches", "/matches")
    with chromium() as browser:
        page = browser.new_page(viewport=DESK)
        faults: list[str] = []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(address)
        assert page.locator("video").count() == 0  # nothing is made that nobody asks for
        page.get_by_role("link", name="Watch the video").click()
        page.wait_for_selector("video", timeout=PATIENCE * 1000)
        assert seconds_played(page) > 0.5
        with page.expect_download() as started:
            page.get_by_role("link", name="Download the video").click()
        assert started.value.suggested_filename == f"match-{number}.mp4"
        assert Path(started.value.path()).read_bytes()[4:8] == b"ftyp"
        assert faults == []

    poster = wait_for(site.client, f"/api/v1/matches/{number}/poster.jpg")
    assert poster.content[:3] == b"\xff\xd8\xff"
    assert f"/api/v1/matches/{number}/poster.jpg" in meta_of(site.client.get(address).text, "og:image")


def seconds_played(page: Any) -> float:
    """Play the video of a page for some time; return how far it comes, s."""
    played: float = page.evaluate(
        """async () => {
            const video = document.querySelector("video");
            video.muted = true;
            await video.play();
            while (video.currentTime < 0.6 && !video.ended) await new Promise((go) => setTimeout(go, 50));
            return video.error ? -1 : video.currentTime;
        }"""
    )
    return played


def wait_for(client: httpx.Client, path: str) -> httpx.Response:
    end = time.monotonic() + PATIENCE
    while (answer := client.get(path)).status_code == 202:
        assert time.monotonic() < end
        time.sleep(0.1)
    assert answer.status_code == 200, answer.text
    return answer


def meta_of(page: str, name: str) -> str:
    """Return the content of a page's meta tag."""
    return page.partition(f'<meta property="{name}" content="')[2].partition('"')[0]


def test_a_video_is_sent_in_pieces_even_while_it_is_used(tmp_path: Path) -> None:
    """Safari plays none from a server that does not do so."""
    with RenderCache(tmp_path) as cache:
        (tmp_path / cache.file_name("video", "1")).write_bytes(b"0123456789")
        app = FastAPI()

        @app.get("/video.mp4")
        def video() -> Response:
            return file_response("video", cache.progress("video", "1", Path("gone.wsr"), datetime.now(UTC)))

        with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
            first = client.get("/video.mp4", headers={"Range": "bytes=0-1"})
            time.sleep(0.01)
            rest = {"Range": "bytes=2-", "If-Range": first.headers["etag"]}

            assert first.status_code == 206
            assert (first.content, first.headers["content-range"]) == (b"01", "bytes 0-1/10")
            assert client.get("/video.mp4", headers=rest).content == b"23456789"
            assert client.get("/video.mp4", headers={"Range": "bytes=10-"}).status_code == 416
            assert client.get("/video.mp4").headers["content-type"] == "video/mp4"


@pytest.mark.parametrize(
    ("seconds", "speed"),
    [(30.0, 1.0), (LONGEST, 1.0), (2.0 * LONGEST, 2.0)],  # in its own time, or faster
)
def test_no_video_is_longer_than_its_bound(seconds: float, speed: float) -> None:
    assert pace_of(seconds).speed == speed


def test_a_video_shows_what_is_public_unless_an_organizer_hides_it(tmp_path: Path) -> None:
    match = Match(MatchSpec(track="battle", map=SMALL_MAP, seats=("submission", "fighter"), time_limit=0.5))
    match.play_out()
    record = tmp_path / "records" / "battle-000-owl.wsr"
    (tmp_path / "records").mkdir()
    (tmp_path / "logs").mkdir()
    write_record(record, match, ["owl", "fighter"])
    said = note_line(0, say="Good luck!", public=True) + note_line(1, say="He is slow.")
    (tmp_path / "logs" / "battle-000-owl.log").write_text(said)
    played = read_record(record)

    assert [note.text for note in public_notes(record, played, Path("7.video-2.mp4"))] == ["Good luck!"]
    assert public_notes(record, played, Path(f"7{QUIET}.video-2.mp4")) == []
