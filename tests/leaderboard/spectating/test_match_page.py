"""The player of a season's match pages in a real browser: waiting, live, and with the names of teams."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.responses import JSONResponse, Response
from tests.browsers import DESK, IN_3D, chromium
from tests.leaderboard.spectating.pages_for_tests import match_page

from wildscav_engine.maps import map_of
from wildscav_engine.record import read_record, resimulate
from wildscav_evaluator.matches.snapshots import snapshot_of
from wildscav_leaderboard.spectating.live import LiveMatches
from wildscav_stage.scene.document import Trails
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.trails import trails_of

pytestmark = pytest.mark.slow

Records = Callable[[str], Path]
HOSTILE = "<img src=x onerror=alert(1)>"
PATIENCE = 60_000  # ms
GZIP = {"Content-Encoding": "gzip"}


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(*IN_3D) as browser:
        yield browser


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page that may neither fail nor break its policy."""
    with browser.new_context(viewport=DESK) as context:
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        faults: list[str] = []
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        yield page
        assert faults == []


@pytest.fixture
def battle(record_of_track: Records) -> Path:
    return record_of_track("battle")


@pytest.fixture
def game_map(battle: Path) -> bytes:
    return map_file(map_of(read_record(battle).spec.map))


def answer_with(trails: Trails) -> Response:
    return Response(trails.compressed(), headers=GZIP, media_type="application/json")


def test_what_is_still_rendered_is_waited_for_and_names_are_text(
    page: Any, battle: Path, game_map: bytes
) -> None:
    trails, asked = trails_of(read_record(battle)), {"trails": 0, "map": 0}

    def answer(name: str, ready: Response) -> Response:
        asked[name] += 1
        return ready if asked[name] > 1 else JSONResponse({"state": "rendering", "detail": "Soon …"}, 202)

    names = json.dumps({0: HOSTILE})
    made = Response(game_map, headers=GZIP)
    with match_page(
        lambda _: answer("trails", answer_with(trails)), lambda: answer("map", made), names
    ) as address:
        page.goto(address)
        page.get_by_text("Soon …").first.wait_for()
        page.locator(".player-canvas").wait_for()

        assert page.locator(".player-name", has_text=HOSTILE).count() == 1
        assert HOSTILE in page.locator(".player-events").text_content()
        assert page.locator(".player img").count() == 0
    assert asked == {"trails": 2, "map": 2}


def test_a_running_match_moves_by_itself_until_its_record_is_there(
    page: Any, tmp_path: Path, battle: Path, game_map: bytes
) -> None:
    record, told = read_record(battle), trails_of(read_record(battle))
    moments = [snapshot_of(match) for match in resimulate(record)]
    live = LiveMatches(tmp_path)
    live.add("m1", record.spec, record.names, moments[:60])
    is_cut = False

    def answer(after: str) -> Response:
        if is_cut:
            return Response("not now", media_type="application/json")
        return answer_with(live.trails("m1", after) or told)

    def wait_for(text: str) -> None:
        page.locator(".player-time", has_text=text).wait_for()

    with match_page(answer, lambda: Response(game_map, headers=GZIP), is_live=True) as address:
        page.goto(address)
        wait_for("0:05 of 0:05")
        live.add("m1", record.spec, record.names, moments[60:210])
        wait_for("0:20 of 0:20")
        page.get_by_role("button", name="Back 5 seconds").click()  # whoever looks back is left alone
        live.add("m1", record.spec, record.names, moments[210:260])
        wait_for("of 0:25")
        assert not page.locator(".player-time").text_content().startswith("0:25")
        page.get_by_role("button", name="Live").click()
        wait_for("0:25 of 0:25")
        is_cut = True
        page.get_by_text("The connection is lost").wait_for()
        is_cut = False
        page.get_by_text("The connection is lost").wait_for(state="detached")
        live.end("m1")
        page.get_by_text("The match is over.").wait_for()

        assert page.locator(".player-events li").count() == len(told.events)
