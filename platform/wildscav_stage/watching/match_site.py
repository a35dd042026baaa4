"""The site of ``wildscav watch``: recorded matches in 3D, for a browser on the same machine."""

import contextlib
import socket
import threading
from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from wildscav.errors import UserError
from wildscav_engine.view.web import LOOPBACK
from wildscav_stage.headers import OwnNames, SecurityHeaders
from wildscav_stage.listening import GRACE
from wildscav_stage.viewer_files import PATH, viewer_routes
from wildscav_stage.watching.match_page import (
    FILES,
    STATIC,
    Scene,
    Shown,
    list_page,
    match_page,
    scene_of,
    text_page,
    title_of,
)

SCENES = 8  # that are kept


def match_site(
    title: str, records: Sequence[Path], host: str = LOOPBACK, logs: Path | None = None
) -> Starlette:
    """Return the site of some records; of one alone, its first page is the match.

    ``/matches/0?with=1`` compares two.

    Args:
        title: Of the list of several.
        records: Their files.
        host: The address that it is served on.
        logs: Where the notes of one record's agents are; see ``notes_beside``.

    Raises:
        UserError: There is one record alone, and it cannot be read, or not be played again.
    """
    playing = threading.Lock()  # a page asks for several files of one match at a time

    @lru_cache(SCENES)
    def scene(number: int) -> Scene:
        return scene_of(records[number], logs)

    if len(records) == 1:
        scene(0)

    def asked_for(request: Request) -> int:
        return existing(request.path_params.get("number", 0))  # the first page has none

    def existing(number: int | str) -> int:
        if not str(number).isdecimal() or int(number) >= len(records):
            raise HTTPException(404)
        return int(number)

    def shown(number: int) -> Shown:
        return Shown(title_of(records[number]), f"/matches/{number}")

    def first(request: Request) -> Response:
        if len(records) == 1:
            return match(request)
        links = [(record.stem, f"/matches/{number}") for number, record in enumerate(records)]
        return HTMLResponse(list_page(title, links))

    def match(request: Request) -> Response:
        others = request.query_params.getlist("with")[:1]
        one, other = asked_for(request), next(map(existing, others), None)
        return HTMLResponse(match_page(shown(one), None if other is None else shown(other)))

    def file(name: str, request: Request) -> Response:
        try:
            number = asked_for(request)
            with playing:
                return file_response(scene(number), name)
        except UserError as error:
            return JSONResponse({"error": str(error)}, 500)

    each = "/matches/{number:int}"
    return Starlette(
        routes=[
            Route("/", first),
            Route(each, match),
            *(Route(f"{each}/{name}", partial(file, name)) for name in FILES),
            Mount("/static", StaticFiles(directory=STATIC)),
            Mount(PATH, viewer_routes()),
        ],
        middleware=[Middleware(SecurityHeaders), Middleware(OwnNames, host=host)],
        exception_handlers={HTTPException: _there_is_no_such_page, UserError: _it_cannot_be_shown},
    )


def file_response(scene: Scene, name: str) -> Response:
    """Return one of the ``FILES`` of a scene."""
    form = "application/octet-stream" if name == "map" else "application/json"
    return Response(getattr(scene, name), headers={"Content-Encoding": "gzip"}, media_type=form)


def _there_is_no_such_page(_request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 404
    return HTMLResponse(text_page("There is nothing here", "Open the link that the command printed."), status)


def _it_cannot_be_shown(_request: Request, error: Exception) -> Response:
    return HTMLResponse(text_page("This match cannot be shown", str(error)), 500)


def serve(site: Starlette, listening: socket.socket) -> None:
    """Serve a site on a socket until Ctrl-C, and close the socket."""
    config = uvicorn.Config(
        site,
        log_level="warning",
        access_log=False,
        lifespan="off",
        server_header=False,
        timeout_graceful_shutdown=GRACE,
    )
    with listening, contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listening])
