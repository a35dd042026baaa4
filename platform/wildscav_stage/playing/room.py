"""The short code with which guests take the free seats of a table, and the page where they enter it."""

import secrets
import time
from collections.abc import AsyncIterator, Callable
from html import escape
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from wildscav.errors import WildscavError
from wildscav_stage.headers import HEADERS
from wildscav_stage.playing.page import Allowance

if TYPE_CHECKING:
    from wildscav_stage.playing.table import Table

LETTERS = "BCDFGHJKLMNPQRSTVWXZ"  # no vowels: there are no words, and nothing looks like 0 or 1
LETTERS_OF_CODE = 6
LASTING = 1800.0  # s that a code is valid
MAX_TRIES, MINUTE = 30, 60.0  # codes that all strangers together may try, in so many s
LONGEST_FORM = 200  # bytes
PAGE = Path(__file__).parents[1] / "static" / "join.html"
POLICY = HEADERS["Content-Security-Policy"].replace("form-action 'none'", "form-action 'self'")


class EntryError(WildscavError):
    """Somebody is not let in.

    Args:
        message: Why, and what to do.
        status: For programs.
    """

    def __init__(self, message: str, status: HTTPStatus) -> None:
        super().__init__(message)
        self.status = status


class Room:
    """Who may come to a table by a code, and until when.

    Args:
        clock: Returns the time, s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._code, self._end = clock, "", 0.0
        self._tries = Allowance(MAX_TRIES, MINUTE, clock)

    @property
    def code(self) -> str:
        """The present code; an empty text if there is none."""
        return self._code if self.seconds_left else ""

    @property
    def seconds_left(self) -> int:
        """How long the code is still valid."""
        return max(0, int(self._end - self._clock()))

    def open(self) -> None:
        """Make another code, which replaces the present one."""
        self._code = "".join(secrets.choice(LETTERS) for _ in range(LETTERS_OF_CODE))
        self._end = self._clock() + LASTING

    def close(self) -> None:
        """End the code."""
        self._end = 0.0

    def check(self, text: str) -> None:
        """Check a code that somebody typed, in letters of either size.

        Raises:
            EntryError: It is wrong, or too many were tried.
        """
        if not self._tries.count():
            raise EntryError(
                "Too many codes were tried. Try again in a minute.", HTTPStatus.TOO_MANY_REQUESTS
            )
        typed = "".join(letter for letter in text.upper() if letter.isalnum())
        if not self.code or not secrets.compare_digest(typed.encode(errors="replace"), self.code.encode()):
            raise EntryError(
                "This code is not valid. It may have ended: ask the host for the present one.",
                HTTPStatus.FORBIDDEN,
            )


class Entrance:
    """The page where guests enter the code of a table.

    Args:
        table: The table.
    """

    def __init__(self, table: "Table") -> None:
        self._table = table
        self.routes = [
            Route("/", lambda _: RedirectResponse("join")),
            Route("/join", self._show),
            Route("/join", self._enter, methods=["POST"]),
        ]

    async def _show(self, request: Request) -> Response:
        return join_page(request.query_params.get("code", ""))

    async def _enter(self, request: Request) -> Response:
        code = await typed_code(request.stream())
        try:
            secret = self._table.let_in(code)
        except EntryError as error:
            return join_page(code, error)
        return RedirectResponse(f"play/{secret}", HTTPStatus.SEE_OTHER)


async def typed_code(body: AsyncIterator[bytes]) -> str:
    """Return the code in a form that was sent; an empty text if it is too long or has none."""
    read = b""
    async for part in body:
        read += part
        if len(read) > LONGEST_FORM:
            return ""
    return parse_qs(read.decode("ascii", "replace")).get("code", [""])[0]


def join_page(code: str = "", error: EntryError | None = None) -> Response:
    """Return the page where a code is entered.

    Args:
        code: What is in the field.
        error: Why it was not taken.
    """
    page = PAGE.read_text("utf-8").replace("{problem}", escape(str(error or "")))
    page = page.replace("{code}", escape(code[:LONGEST_FORM]))
    status = error.status if error else HTTPStatus.OK
    return HTMLResponse(page, status, {"Content-Security-Policy": POLICY})
