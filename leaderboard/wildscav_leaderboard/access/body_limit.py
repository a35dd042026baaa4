"""How much a request may send. Forms and documents are read into memory, so they are short."""

from collections.abc import Set
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from wildscav_leaderboard.seasons.refusals import TooLargeError

LARGEST = 256 << 10  # bytes


class BodyLimit:
    """Refuses requests that send too much. Middleware.

    Args:
        app: The application.
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
