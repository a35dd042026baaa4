"""The player of a season's match pages in a real browser: waiting, live, and with the names of teams."""

import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from html import escape
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, JSONResponse, Response
from fastapi.staticfiles import StaticFiles
from tests.browsers import DESK, IN_3D, chromium
from tests.leaderboard.spectating.moments import moments_of
from tests.leaderboard.spectating.served import served

import wildscav_leaderboard
from wildscav_engine.maps import map_of
from wildscav_engine.record import read_record
from wildscav_leaderboard.hosting.middleware import POLICY
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_leaderboard.spectating.streams import Streams
from wildscav_stage.scene.document import Trails
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.trails import trails_of
from wildscav_stage.viewer_files import PATH, viewer_addresses, viewer_routes

pytestmark = pytest.mark.slow

Records = Callable[[str], Path]
HOSTILE = "<img src=x onerror=alert(1)>"
PATIENCE = 60_000  # ms
GZIP = {"Content-Encoding": "gzip"}
STATIC = Path(wildscav_leaderboard.__file__).parent / "web" / "static"
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>A match</title>
<link rel="stylesheet" href="/static/season.css"><link rel="stylesheet" href="{style}">
<script type="module" src="{script}"></script>
</head>
<body>
<main><h1>A match</h1><div data-match data-map="/map" data-trails="/trails?v=3" {attributes}></div></main>
</body>
</html>
"""


@contextmanager
def match_page(
    trails: Callable[[], Response],
    game_map: Callable[[], Response],
    names: str = "{}",
    live: Callable[[Request], Response] | None = None,
) -> Iterator[str]:
    """Serve a page with the player, as a match page has it, and give its address; perhaps it is live."""
    app = FastAPI()
    app.mount("/static", StaticFiles(directory=STATIC))
    app.mount(PATH, viewer_routes())
    script, style = viewer_addresses()
    is_live = ' data-live="/live"' if live else ""
    written = f'data-names="{escape(names)}"{is_live}'
    page = PAGE.format(script=script, style=style, attributes=written)

    @app.get("/")
    def show() -> HTMLResponse:
        return HTMLResponse(page, headers={"Content-Security-Policy": POLICY})

    @app.get("/favicon.ico")
    def icon() -> Response:
        return Response(status_code=204)

    @app.get("/trails")
    def answer() -> Response:
        return trails()

    @app.get("/live")
    async def follow(request: Request) -> Response:
        return live(request) if live else Response(status_code=404)

    @app.get("/map")
    def answer_map() -> Response:
        return game_map()

    with served(app) as address:
        yield address


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


async def shown_to_all(_match: int) -> str:
    return ""


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
    trails_in, map_in = (lambda: answer("trails", answer_with(trails))), (lambda: answer("map", made))
    with match_page(trails_in, map_in, names) as address:
        page.goto(address)
        page.get_by_text("Soon …").first.wait_for()
        page.locator(".player-canvas").wait_for()

        assert page.locator(".player-name", has_text=HOSTILE).count() == 1
        assert HOSTILE in page.locator(".player-events").text_content()
        assert page.locator(".player img").count() == 0
    assert asked == {"trails": 2, "map": 2}


def test_a_map_that_failed_can_be_asked_for_again(page: Any, battle: Path, game_map: bytes) -> None:
    answers = [JSONResponse({"detail": "Not now"}, 200), Response(game_map, headers=GZIP)]
    with match_page(lambda: answer_with(trails_of(read_record(battle))), lambda: answers.pop(0)) as address:
        page.goto(address)
        page.get_by_text("The map cannot be shown").wait_for()
        page.get_by_role("button", name="Try again").click()
        page.locator(".player-canvas").wait_for()


def test_a_running_match_moves_by_itself_until_its_record_is_there(
    page: Any, tmp_path: Path, battle: Path, game_map: bytes
) -> None:
    record, told = read_record(battle), trails_of(read_record(battle))
    moments = list(moments_of(record))
    live = LiveMatches(tmp_path)
    live.add(key_of(7), record.spec, record.names, moments[:60])
    following = Streams(live, shown_to_all)
    asked = 0

    def follow(request: Request) -> Response:
        nonlocal asked
        asked += 1
        if asked == 1:
            return Response(media_type="text/event-stream")  # which ends at once
        return following.follow(request, 7, "somebody", everything=False)

    def wait_for(text: str) -> None:
        page.locator(".player-time", has_text=text).wait_for()

    made = Response(game_map, headers=GZIP)
    with match_page(lambda: answer_with(told), lambda: made, live=follow) as address, ExitStack() as stack:
        stack.callback(live.end, key_of(7))  # or the server would wait for the end of the stream
        page.goto(address)
        page.get_by_text("The connection is lost").wait_for()
        wait_for("0:05 of 0:05")
        page.locator(".player-behind", has_text="s behind").wait_for()
        live.add(key_of(7), record.spec, record.names, moments[60:210])
        wait_for("0:20 of 0:20")
        page.get_by_role("button", name="Back 5 seconds").click()  # whoever looks back is left alone
        live.add(key_of(7), record.spec, record.names, moments[210:260])
        wait_for("of 0:25")
        assert not page.locator(".player-time").text_content().startswith("0:25")
        page.get_by_role("button", name="Live").click()
        wait_for("0:25 of 0:25")
        assert page.locator(".player-events li").count() == sum(event.frame < 1300 for event in told.events)
        live.end(key_of(7))
        page.get_by_text("The match is over.").wait_for()

        assert page.locator(".player-events li").count() == len(told.events)
        assert page.locator(".player-behind").is_hidden()
