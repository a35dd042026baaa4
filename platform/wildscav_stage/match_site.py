"""The site of ``wildscav watch``: recorded matches in 3D, for a browser on the same machine."""

import contextlib
import socket
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from wildscav.errors import UserError
from wildscav_stage.headers import SecurityHeaders
from wildscav_stage.match_page import STATIC, Scene, list_page, match_page, scene_of, text_page
from wildscav_stage.viewer_files import PATH, viewer_routes

SCENES = 8  # that are kept
JSON, BYTES = "application/json", "application/octet-stream"


def match_site(title: str, records: Sequence[Path]) -> Starlette:
    """Return the site of some records; of one alone, its first page is the match.

    Args:
        title: Of the list of several.
        records: Their files.

    Raises:
        UserError: There is one record alone, and it cannot be read, or not be played again.
    """

    @lru_cache(SCENES)
    def scene(number: int) -> Scene:
        return scene_of(records[number])

    if len(records) == 1:
        scene(0)

    def asked_for(request: Request) -> tuple[str, Scene]:
        number = request.path_params.get("number", 0)  # the first page has none
        if number >= len(records):
            raise HTTPException(404)
        return f"/matches/{number}", scene(number)

    def first(request: Request) -> Response:
        if len(records) == 1:
            return match(request)
        links = [(record.stem, f"/matches/{number}") for number, record in enumerate(records)]
        return HTMLResponse(list_page(title, links))

    def match(request: Request) -> Response:
        address, found = asked_for(request)
        return HTMLResponse(match_page(found.title, address))

    def game_map(request: Request) -> Response:
        return Response(asked_for(request)[1].map, headers={"Content-Encoding": "gzip"}, media_type=BYTES)

    def trails(request: Request) -> Response:
        return Response(asked_for(request)[1].trails, headers={"Content-Encoding": "gzip"}, media_type=JSON)

    each = "/matches/{number:int}"
    return Starlette(
        routes=[
            Route("/", first),
            Route(each, match),
            Route(f"{each}/map", game_map),
            Route(f"{each}/trails", trails),
            Mount("/static", StaticFiles(directory=STATIC)),
            Mount(PATH, viewer_routes()),
        ],
        middleware=[Middleware(SecurityHeaders)],
        exception_handlers={HTTPException: _there_is_no_such_page, UserError: _it_cannot_be_shown},
    )


def _there_is_no_such_page(_request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 404
    return HTMLResponse(text_page("There is nothing here", "Open the link that the command printed."), status)


def _it_cannot_be_shown(_request: Request, error: Exception) -> Response:
    return HTMLResponse(text_page("This match cannot be shown", str(error)), 500)


def serve(site: Starlette, listening: socket.socket) -> None:
    """Serve a site on a socket until Ctrl-C, and close the socket."""
    config = uvicorn.Config(site, log_level="warning", access_log=False, lifespan="off", server_header=False)
    with listening, contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listening])
