"""The web application: the page, its scripts, and the WebSocket of whoever has the secret link."""

import secrets
from pathlib import Path
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.datastructures import MutableHeaders
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from wildscav.play.page import Page
from wildscav.play.table import Table

STATIC = Path(__file__).parent / "static"
NO_ACCESS = 4004  # close code for a link that is not valid
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
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
    """

    def __init__(self, table: Table) -> None:
        self.secret = secrets.token_urlsafe(16)
        self._table = table
        self._page: Page | None = None  # the one that is open
        self.app = Starlette(
            routes=[
                Route("/play/{secret}", self._show),
                WebSocketRoute("/play/{secret}/socket", self._connect),
                Mount("/static", StaticFiles(directory=STATIC)),
            ],
            middleware=[Middleware(SecurityHeaders)],
        )

    @property
    def path(self) -> str:
        """The path of the person's link."""
        return f"/play/{self.secret}"

    def _is_secret(self, text: str) -> bool:
        return secrets.compare_digest(text.encode(), self.secret.encode())

    async def _show(self, request: Request) -> Response:
        if not self._is_secret(request.path_params["secret"]):
            return PlainTextResponse("this link is not valid: use the one that the command prints\n", 404)
        return FileResponse(STATIC / "play.html")

    async def _connect(self, socket: WebSocket) -> None:
        if not self._is_secret(socket.path_params["secret"]) or not _is_own_page(socket):
            await socket.close(NO_ACCESS)
            return
        await socket.accept()
        if self._page is not None:
            await self._page.replace()
        page = self._page = Page(socket, self._table)
        try:
            await page.serve()
        finally:
            if self._page is page:
                self._page = None


def _is_own_page(socket: WebSocket) -> bool:
    """Return whether a page of this site opens a WebSocket; programs other than browsers do not say."""
    origin = socket.headers.get("origin")
    return origin is None or urlsplit(origin).netloc == socket.headers.get("host")
