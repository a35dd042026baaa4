"""A page with the player of trails, as a match page has it, on a real server."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import HTMLResponse, JSONResponse, Response
from fastapi.staticfiles import StaticFiles
from tests.leaderboard.spectating.served import served

import wildscav_leaderboard

STATIC = Path(wildscav_leaderboard.__file__).parent / "web" / "static"
POLICY = "default-src 'self'; object-src 'none'; base-uri 'none'"
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>A match</title>
<link rel="stylesheet" href="/static/season.css"><link rel="stylesheet" href="/static/trails.css">
</head>
<body>
<main><h1>A match</h1><div {attributes}></div></main>
<script type="module" src="/static/trails.js"></script>
</body>
</html>
"""


@contextmanager
def trails_page(
    trails: Callable[[str], Response],
    overview: bytes | None = None,
    names: str | None = None,
    *,
    is_live: bool = False,
    drawn_after: int = 0,
) -> Iterator[str]:
    """Serve a page with the player, and give its address.

    Args:
        trails: Answers with the trails after a cursor.
        overview: The picture of the map; None if there is none.
        names: The names of seats as people read them, as JSON; None if the page does not know them.
        is_live: Whether the match is being played.
        drawn_after: How often the picture of the map is asked for before it is drawn.
    """
    app, asked = FastAPI(), list[str]()
    app.mount("/static", StaticFiles(directory=STATIC))
    attributes = {"data-trails": "/trails.json"}
    if overview is not None:
        attributes["data-overview"] = "/overview.webp"
    if names is not None:
        attributes["data-names"] = names
    if is_live:
        attributes["data-live"] = ""
    written = " ".join(f'{name}="{escape(value)}"' for name, value in attributes.items())

    @app.get("/")
    def page() -> HTMLResponse:
        return HTMLResponse(PAGE.format(attributes=written), headers={"Content-Security-Policy": POLICY})

    @app.get("/favicon.ico")
    def icon() -> Response:
        return Response(status_code=204)

    @app.get("/trails.json")
    def answer(after: str = "") -> Response:
        return trails(after)

    @app.get("/overview.webp")
    def picture() -> Response:
        if len(asked) < drawn_after:
            asked.append("")
            return JSONResponse({"state": "rendering", "detail": ""}, 202)
        return Response(overview or b"", media_type="image/webp")

    with served(app) as address:
        yield address
