"""Requests that an error broke which nobody expected: they are answered, and the error goes on to the log."""

from collections.abc import Callable

from fastapi import Request
from fastapi.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send


class BrokenRequests:
    """Answers a request that broke before its answer began. Middleware, the innermost one.

    It stands inside of what adds headers to every answer, so this one has them too. The error is raised
    again.

    Args:
        app: The application.
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
