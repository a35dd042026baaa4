"""The page that a refused request is answered with."""

from http import HTTPStatus
from urllib.parse import urlencode

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import RedirectResponse, Response
from starlette.exceptions import HTTPException

from wildscav.errors import UserError
from wildscav_leaderboard.database.connection import DatabaseError
from wildscav_leaderboard.seasons.refusals import UnknownCallerError
from wildscav_leaderboard.web.rendering import page


def as_page(request: Request, error: Exception) -> Response:
    """Return the page that answers an error; whoever is not logged in is sent to do that first."""
    if isinstance(error, UnknownCallerError) and request.url.path != "/login":
        return RedirectResponse(f"/login{_following(request)}", HTTPStatus.SEE_OTHER)
    status, text = _answer(error)
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


def _answer(error: Exception) -> tuple[int, str]:
    if isinstance(error, DatabaseError):
        return HTTPStatus.SERVICE_UNAVAILABLE, "The database does not answer. Try again in a moment."
    if isinstance(error, UserError):
        return getattr(error, "status", HTTPStatus.NOT_FOUND), str(error)
    if isinstance(error, HTTPException):
        return error.status_code, ""
    if isinstance(error, RequestValidationError):
        return HTTPStatus.UNPROCESSABLE_ENTITY, "A value in the address or in the form is not valid."
    return HTTPStatus.INTERNAL_SERVER_ERROR, "Something went wrong here. The organizers can see what."
