"""All routes of the API, and what a refused request is answered with: one line, whatever went wrong."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from starlette.exceptions import HTTPException

from wildscav_leaderboard.api import accounts, audit, boards, matches, organizing, season, submissions, teams
from wildscav_leaderboard.api.documents import ErrorView

HEADERS: dict[int, dict[str, str]] = {
    HTTPStatus.UNAUTHORIZED: {"WWW-Authenticate": "Bearer"},
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE: {"Connection": "close"},  # or all of it would be read
}
PREFIX = "/api/v1"
ERRORS: dict[int | str, dict[str, Any]] = {"4XX": {"model": ErrorView}}


def api_router() -> APIRouter:
    """Return the router of the API."""
    router = APIRouter(prefix=PREFIX, responses=ERRORS)
    for part in (season, boards, accounts, teams, submissions, matches, organizing, audit):
        router.include_router(part.router)
    return router


def answer(error: Exception) -> tuple[int, str]:
    """Return the status and the one line that an error is answered with."""
    from wildscav.errors import UserError
    from wildscav_leaderboard.database.connection import DatabaseError

    if isinstance(error, DatabaseError):
        return HTTPStatus.SERVICE_UNAVAILABLE, "the database does not answer: try again in a moment"
    if isinstance(error, UserError):
        return getattr(error, "status", HTTPStatus.NOT_FOUND), str(error)
    if isinstance(error, HTTPException):
        return error.status_code, str(error.detail)
    if isinstance(error, RequestValidationError):
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"][1:])
        return HTTPStatus.UNPROCESSABLE_ENTITY, f"{field}: {first['msg']}" if field else str(first["msg"])
    return HTTPStatus.INTERNAL_SERVER_ERROR, "something went wrong here: the organizers can see what"


def as_json(error: Exception) -> Response:
    """Return the answer of the API to an error."""
    status, text = answer(error)
    return JSONResponse(ErrorView(error=text, status=status).model_dump(), status, HEADERS.get(status))
