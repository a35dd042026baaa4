"""All pages of the web site, and the page that answers an error."""

from http import HTTPStatus
from urllib.parse import urlencode

from fastapi import FastAPI, Request
from fastapi.responses import RedirectResponse, Response
from starlette.exceptions import HTTPException
from starlette.staticfiles import StaticFiles

from wildscav_leaderboard.api.routers import answer
from wildscav_leaderboard.seasons.refusals import UnknownCallerError
from wildscav_leaderboard.web import boards, feeds, organizing, people, playing, public, watching
from wildscav_leaderboard.web.rendering import FOLDER, PageParts, page
from wildscav_stage.viewer_files import PATH, viewer_routes


def as_page(request: Request, error: Exception) -> Response:
    """Return the page that answers an error; whoever is not logged in is sent to do that first."""
    if isinstance(error, UnknownCallerError) and request.url.path != "/login":
        return RedirectResponse(f"/login{_following(request)}", HTTPStatus.SEE_OTHER)
    status, text = answer(error)
    if isinstance(error, HTTPException):
        text = ""  # the title says it
    caller = getattr(request.state, "caller", None)
    return page(request, "error.html", caller, status, number=status, title=_title(status), text=text)


def _following(request: Request) -> str:
    """Return what tells the page to log in which page was asked for, if it was not a form."""
    if request.method != "GET":
        return ""
    query = f"?{request.url.query}" if request.url.query else ""
    return f"?{urlencode({'following': f'{request.url.path}{query}'})}"


def _title(status: int) -> str:
    return "This page does not exist" if status == HTTPStatus.NOT_FOUND else HTTPStatus(status).phrase


def add_pages(app: FastAPI) -> None:
    """Add the pages to an application."""
    for part in (public, boards, watching, playing, feeds, people, organizing):
        app.include_router(part.router, include_in_schema=False)
    app.state.page_parts = PageParts()
    app.mount(PATH, viewer_routes(), name="viewer")
    app.mount("/static", StaticFiles(directory=FOLDER / "static"), name="static")
