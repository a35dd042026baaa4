"""Middleware of the web server: limits of bodies, headers, broken requests, and HEAD."""

from collections.abc import Callable, MutableMapping, Set
from http import HTTPStatus
from typing import Any

from fastapi import Request
from fastapi.responses import Response
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from wildscav_leaderboard.seasons.refusals import TooLargeError

LARGEST = 256 << 10  # bytes


class BodyLimit:
    """Refuses requests that send too much. Middleware.

    Args:
        uploads: The paths of uploads, which are written to disk and have a limit of their own.
    """

    def __init__(self, app: ASGIApp, uploads: Set[str]) -> None:
        self._app, self._uploads = app, uploads

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["path"] in self._uploads:
            await self._app(scope, receive, send)
            return
        announced = Headers(scope=scope).get("content-length", "0")
        if announced.isdecimal() and int(announced[:20]) > LARGEST:
            await _refusal()(scope, receive, send)
            return
        received = 0

        async def receive_some() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > LARGEST:  # of a request that did not announce it
                raise TooLargeError(f"a request may have {LARGEST >> 10} KiB at most")
            return message

        await self._app(scope, receive_some, send)


def _refusal() -> JSONResponse:
    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
    error = {"error": f"a request may have {LARGEST >> 10} KiB at most", "status": status}
    return JSONResponse(error, status, {"Connection": "close"})  # or all of it would be read


# Everything comes from here; nothing is inline; no other site may show a page in a frame.
POLICY = (
    "default-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'self'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
}
TLS_HEADERS = {"Strict-Transport-Security": "max-age=31536000"}


class SecurityHeaders:
    """Adds the headers, except those that an answer has already. Middleware."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                _complete(message, scope)
            await send(message)

        await self._app(scope, receive, send_with_headers)


def _complete(message: MutableMapping[str, Any], scope: Scope) -> None:
    headers = MutableHeaders(scope=message)
    added = HEADERS | (TLS_HEADERS if scope.get("scheme") == "https" else {})
    for name, value in added.items():
        headers.setdefault(name, value)
    # What is not for everybody, and says so, may be other for whoever asks next: no shared cache may keep it.
    if "public" not in headers.setdefault("Cache-Control", "private"):
        headers.add_vary_header("Cookie, Authorization")


class BrokenRequests:
    """Answers a request that broke before its answer began. Middleware, the innermost one.

    It stands inside of what adds headers to every answer, so this one has them too. The error is raised
    again.

    Args:
        answer: Returns the answer to an error.
    """

    def __init__(self, app: ASGIApp, answer: Callable[[Request, Exception], Response]) -> None:
        self._app, self._answer = app, answer

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        has_begun = False

        async def send_and_note(message: Message) -> None:
            nonlocal has_begun
            has_begun = True
            await send(message)

        try:
            await self._app(scope, receive, send_and_note)
        except Exception as error:
            if scope["type"] == "http" and not has_begun:
                await self._answer(Request(scope), error)(scope, receive, send)
            raise


class HeadRequests:
    """Has HEAD answered as GET is; the server sends no body then. Middleware."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return

        async def send_head(message: Message) -> None:
            scope["method"] = "HEAD"  # which the server and the log read again
            await send(message)

        scope["method"] = "GET"
        await self._app(scope, receive, send_head)
