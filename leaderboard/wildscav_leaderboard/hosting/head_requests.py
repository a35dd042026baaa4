"""Requests for the head of an answer alone: every address that answers GET answers HEAD as well."""

from starlette.types import ASGIApp, Message, Receive, Scope, Send


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
