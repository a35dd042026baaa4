"""The web application: the page, its scripts, and the WebSocket of whoever has the secret link."""

from pathlib import Path
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from wildscav.play.links import Base, Links
from wildscav.play.player_page import PlayerPage
from wildscav.play.spectator_page import SpectatorPage
from wildscav.play.table import Table

STATIC = Path(__file__).parent / "static"
NO_ACCESS = 4004  # close code for a link that is not valid
PROBLEMS = {  # with links: a title and what to do, in HTML
    "wrong": (
        "This link is not valid",
        """It may be incomplete: copy all of it. Or it is of an earlier game: all links change when the
        game is started anew, so ask whoever invited you for a new one.""",
    ),
    "renewed": (
        "This link was replaced",
        "The host has made a new link for this seat. Ask the host for it.",
    ),
    "nothing": (
        "There is nothing here",
        "To play or to watch, open the whole link that you were sent.",
    ),
}
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


class SecurityHeaders:
    """Adds headers to every response."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        await self._app(scope, receive, send_with_headers)


class Site:
    """The site of one table.

    Args:
        table: The table.
        links: Its links.
        base: Where its pages are reached.
    """

    def __init__(self, table: Table, links: Links, base: Base) -> None:
        self._table, self._links, self._base = table, links, base
        self.app = Starlette(
            routes=[
                Route("/play/{secret}", self._show),
                WebSocketRoute("/play/{secret}/socket", self._connect),
                Route("/watch/{secret}", self._show_match),
                WebSocketRoute("/watch/{secret}/socket", self._connect_spectator),
                Mount("/static", StaticFiles(directory=STATIC)),
                Route("/{path:path}", _show_nothing),
            ],
            middleware=[Middleware(SecurityHeaders)],
        )

    async def _show(self, request: Request) -> Response:
        secret = request.path_params["secret"]
        if self._links.seat_of(secret) is not None:
            return FileResponse(STATIC / "play.html")
        return _explain("renewed" if self._links.was_replaced(secret) else "wrong", request)

    async def _connect(self, socket: WebSocket) -> None:
        seat = self._links.seat_of(socket.path_params["secret"])
        if seat is None or not self._is_own_page(socket):
            await socket.close(NO_ACCESS)
            return
        await socket.accept()
        await PlayerPage(socket, self._table, seat).serve()

    async def _show_match(self, request: Request) -> Response:
        if self._links.is_watching(request.path_params["secret"]):
            return FileResponse(STATIC / "watch.html")
        return _explain("wrong", request)

    async def _connect_spectator(self, socket: WebSocket) -> None:
        if not self._links.is_watching(socket.path_params["secret"]) or not self._is_own_page(socket):
            await socket.close(NO_ACCESS)
            return
        await socket.accept()
        await SpectatorPage(socket, self._table).serve()

    def _is_own_page(self, socket: WebSocket) -> bool:
        """Return whether a page of this site opens a WebSocket; programs other than browsers do not say."""
        origin = socket.headers.get("origin")
        own = socket.headers.get("host"), urlsplit(self._base.invited).netloc
        return origin is None or urlsplit(origin).netloc in own


async def _show_nothing(request: Request) -> Response:
    return _explain("nothing", request)


def _explain(problem: str, request: Request) -> Response:
    """Return the page that says what is wrong with a link."""
    title, words = PROBLEMS[problem]
    root = "../" * (request.url.path.count("/") - 1)  # relative, as a proxy may serve the site below a path
    page = (STATIC / "problem.html").read_text("utf-8").replace("{root}", root)
    return HTMLResponse(page.replace("{title}", title).replace("{words}", words), 404)
