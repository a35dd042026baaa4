"""All routes of the API."""

from typing import Any

from fastapi import APIRouter

from wildscav_leaderboard.api import accounts, audit, boards, matches, organizing, submissions, teams
from wildscav_leaderboard.presentation.documents import ErrorView

PREFIX = "/api/v1"
ERRORS: dict[int | str, dict[str, Any]] = {"4XX": {"model": ErrorView}}


def api_router() -> APIRouter:
    """Return the router of the API."""
    router = APIRouter(prefix=PREFIX, responses=ERRORS)
    for part in (boards, accounts, teams, submissions, matches, organizing, audit):
        router.include_router(part.router)
    return router
