"""The web application: the page, its scripts, and the WebSocket of whoever has the secret link."""

import json
from http import HTTPStatus
from pathlib import Path
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket

from wildscav.errors import UserError
from wildscav_stage.headers import SecurityHeaders
from wildscav_stage.playing.inputs import (
    Arrange,
    Command,
    Free,
    Input,
    InputError,
    OpenRoom,
    Pause,
    Ready,
    Rename,
    Seen,
    Start,
    decode_message,
    decode_of_spectator,
)
from wildscav_stage.playing.links import Base, Links
from wildscav_stage.playing.lobby import LobbyError
from wildscav_stage.playing.page import (
    POLICY_VIOLATION,
    SEATED,
    TOO_MANY,
    UNSUPPORTED,
    Allowance,
    OpenPage,
    PageClosedError,
)
from wildscav_stage.playing.sight import Known
from wildscav_stage.playing.site.entrance import Entrance
from wildscav_stage.playing.site.replays import UNSHOWN, Replays
from wildscav_stage.playing.table import MAX_SPECTATORS, Table
from wildscav_stage.viewer_files import PATH, versioned, viewer_routes

MAX_COMMANDS = 10  # a second: whatever is told to everybody
STATIC = Path(__file__).parents[2] / "static"
NO_ACCESS = 4004  # close code for a link that is not valid
PROBLEMS = {  # with links: a title and what to do, in HTML
    "wrong": (
        "This link is not valid",
        """It may be incomplete: copy all of it. Or it is of an earlier game: all links change when the
        game is started anew, so ask whoever invited you for a new one.""",
    ),
    "renewed": (
        "This link was replaced",
        "The host has freed this seat, or somebody took it by a code. Ask the host for another link.",
    ),
    "nothing": (
        "There is nothing here",
        "To play or to watch, open the whole link that you were sent.",
    ),
    "unshown": ("This match cannot be shown", UNSHOWN),
}


class SpectatorPage(OpenPage):
    """Serves a spectator's page, who may have a seat that they can take later, until it is closed."""

    def __init__(self, socket: WebSocket, table: Table, seat: int | None) -> None:
        super().__init__(socket)
        self._table, self._seat = table, seat

    async def serve(self) -> None:
        """Serve the page until it is closed."""
        if not self._table.admit(self, self._seat):
            return await self._socket.close(TOO_MANY, f"{MAX_SPECTATORS} people watch already")
        try:
            await self._serve(self._receive(), self._send_moments())
        finally:
            self._table.dismiss(self)

    async def _send_moments(self) -> None:
        number = 0
        while True:
            number, body = await self._table.audience.next(number)
            await self._send_moment("all", body)

    async def _receive(self) -> None:
        async for text in self._texts():
            try:
                message = decode_of_spectator(text)
            except InputError as error:
                raise PageClosedError(UNSUPPORTED, f"spectators only watch: {error}") from None
            self._note_seen(message.number)


class PlayerPage(OpenPage):
    """Serves the page of a seat until it is closed."""

    def __init__(self, socket: WebSocket, table: Table, seat: int) -> None:
        super().__init__(socket)
        self._table, self._seat = table, seat
        self._player = table.lobby.seats[seat]
        self._commands = Allowance(MAX_COMMANDS)

    async def serve(self) -> None:
        """Serve the page until it is closed, or another page takes its place."""
        self._table.attach(self._seat, self)
        try:
            await self._serve(self._receive(), self._send_moments())
        finally:
            self._table.detach(self._seat, self)

    async def _send_moments(self) -> None:
        """Send what is new to the seat as long as the page has seen the last moments."""
        known = Known()
        while True:
            told = await self._player.person.look(known)
            await self._send_moment("now", json.dumps(told, separators=(",", ":"))[1:])

    async def _receive(self) -> None:
        async for text in self._texts():
            try:
                message = decode_message(text)
            except InputError as error:
                raise PageClosedError(UNSUPPORTED, str(error)) from None
            match message:
                case Input():
                    self._player.person.controls.receive(message)
                case Seen():
                    self._note_seen(message.number)
                case _:
                    self._command(message)

    def _command(self, message: Command) -> None:
        """Do what everybody is told of."""
        if not self._commands.count():
            raise PageClosedError(POLICY_VIOLATION, "too many messages")
        table, seat = self._table, self._seat
        try:
            match message:
                case Start():
                    table.start(seat)
                case Pause():
                    table.pause(message.paused)
                case Ready():
                    table.vote(seat, ready=message.ready)
                case Rename():
                    table.lobby.rename(seat, message.name)
                case Free():
                    table.free(seat, message.seat)
                case OpenRoom():
                    table.lobby.open_room(seat, is_open=message.open)
                case Arrange():
                    table.lobby.arrange(seat, message.robots, new_map=message.new_map)
            table.tell_people()
        except LobbyError as error:
            self.tell({"kind": "refused", "message": str(error)})


class Site:
    """The site of one table."""

    def __init__(self, table: Table, links: Links, base: Base) -> None:
        self._table, self._links, self._base = table, links, base
        self.app = Starlette(
            routes=[
                Route("/play/{secret}", self._show),
                Route("/play/{secret}/map", self._send_map),
                WebSocketRoute("/play/{secret}/socket", self._connect),
                Route("/watch/{secret}", self._show_match),
                Route("/watch/{secret}/map", self._send_map),
                WebSocketRoute("/watch/{secret}/socket", self._connect_spectator),
                *(Entrance(table).routes if len(table.lobby.seats) > 1 else ()),
                *Replays(table).routes,
                Mount("/static/viewer", viewer_routes()),  # compressed
                Mount(PATH, viewer_routes()),  # the same, for the pages of matches
                Mount("/static", StaticFiles(directory=STATIC)),
                Route("/{path:path}", _show_nothing),
            ],
            middleware=[Middleware(SecurityHeaders)],
            exception_handlers={HTTPException: _show_nothing, UserError: _show_no_match},
        )

    async def _show(self, request: Request) -> Response:
        secret = request.path_params["secret"]
        if self._links.seat_of(secret) is not None:
            return _page("play.html", "play.js")
        return _explain("renewed" if self._links.was_replaced(secret) else "wrong", request)

    async def _connect(self, socket: WebSocket) -> None:
        seat = self._links.seat_of(socket.path_params["secret"])
        if seat is None or not self._is_own_page(socket):
            await socket.close(NO_ACCESS)
            return
        await socket.accept()
        await PlayerPage(socket, self._table, seat).serve()

    async def _show_match(self, request: Request) -> Response:
        if self._links.opens_match(request.path_params["secret"]):
            return _page("watch.html", "spectate.js")
        return _explain("wrong", request)

    async def _connect_spectator(self, socket: WebSocket) -> None:
        secret = socket.path_params["secret"]
        seat = self._links.seat_of(secret)
        if not self._links.opens_match(secret) or not self._is_own_page(socket):
            await socket.close(NO_ACCESS)
            return
        await socket.accept()
        if seat is None or self._table.is_waiting(seat):
            await SpectatorPage(socket, self._table, seat).serve()
        else:
            await socket.close(SEATED, "whoever plays does not watch")

    async def _send_map(self, request: Request) -> Response:
        """Send the map of the present match, or of the last one."""
        secret, watches = request.path_params["secret"], request.url.path.startswith("/watch/")
        valid = self._links.opens_match(secret) if watches else self._links.seat_of(secret) is not None
        if not valid or self._table.map_file is None:
            return _explain("wrong" if not valid else "nothing", request)
        key = f'"{self._table.map_key}"'
        headers = {"ETag": key, "Cache-Control": "no-cache"}
        if key in request.headers.get("if-none-match", ""):
            return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
        return Response(self._table.map_file, media_type="application/octet-stream", headers=headers)

    def _is_own_page(self, socket: WebSocket) -> bool:
        """Return whether a page of this site opens a WebSocket; programs other than browsers do not say."""
        origin = socket.headers.get("origin")
        own = socket.headers.get("host"), urlsplit(self._base.invited).netloc
        return origin is None or urlsplit(origin).netloc in own


def _page(name: str, script: str) -> Response:
    """Return a page, with a script that a browser keeps as long as it does not change."""
    return HTMLResponse((STATIC / name).read_text("utf-8").replace("{script}", versioned(script)))


async def _show_nothing(request: Request, error: Exception | None = None) -> Response:
    return _explain("nothing", request, error.status_code if isinstance(error, HTTPException) else 404)


async def _show_no_match(request: Request, _error: Exception) -> Response:
    return _explain("unshown", request, 500)


def _explain(problem: str, request: Request, status: int = 404) -> Response:
    """Return the page that says what is wrong with a link."""
    title, words = PROBLEMS[problem]
    root = "../" * (request.url.path.count("/") - 1)  # relative, as a proxy may serve the site below a path
    page = (STATIC / "problem.html").read_text("utf-8").replace("{root}", root)
    return HTMLResponse(page.replace("{title}", title).replace("{words}", words), status)
