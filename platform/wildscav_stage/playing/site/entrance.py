"""The page where guests enter the code of a table."""

from collections.abc import AsyncIterator
from html import escape
from http import HTTPStatus
from pathlib import Path
from urllib.parse import parse_qs

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from wildscav_stage.headers import HEADERS
from wildscav_stage.playing.room import EntryError
from wildscav_stage.playing.table import Table

LONGEST_FORM = 200  # bytes
PAGE = Path(__file__).parents[2] / "static" / "join.html"
# The form is sent to this site, which may ask from where it comes.
HEADERS_OF_FORM = {
    "Content-Security-Policy": HEADERS["Content-Security-Policy"].replace(
        "form-action 'none'", "form-action 'self'"
    ),
    "Referrer-Policy": "same-origin",
}


class Entrance:
    """The page where guests enter the code of a table."""

    def __init__(self, table: Table) -> None:
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
    """Return the page where a code is entered, with what is in the field and why it was not taken."""
    page = PAGE.read_text("utf-8").replace("{problem}", escape(str(error or "")))
    page = page.replace("{code}", escape(code[:LONGEST_FORM]))
    status = error.status if error else HTTPStatus.OK
    return HTMLResponse(page, status, HEADERS_OF_FORM)
