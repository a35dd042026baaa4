"""A page with the player of a match, as a match page has it, on a real server."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, Response
from fastapi.staticfiles import StaticFiles
from tests.leaderboard.spectating.served import served

import wildscav_leaderboard
from wildscav_leaderboard.hosting.middleware import POLICY
from wildscav_stage.viewer_files import PATH, viewer_addresses, viewer_routes

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
    """Serve a page with the player, and give its address.

    Args:
        trails: Answers with the trails.
        game_map: Answers with the map.
        names: The names of seats as people read them, as JSON.
        live: Answers with the stream of a match that is being played; None if it is over.
    """
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
