"""Routes of the season and its boards."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response

from wildscav_leaderboard.access.requests import AnyProgram, CurrentSeason, Number, Reading, check_organizer
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.boards.history import history, team_histories
from wildscav_leaderboard.boards.kept import kept_board, read_board
from wildscav_leaderboard.boards.models import HIDDEN, audience_of
from wildscav_leaderboard.matches.visibility import shown_until
from wildscav_leaderboard.presentation.boards import head_to_head_view, ladder_of, point_views
from wildscav_leaderboard.presentation.documents import (
    AnnouncementView,
    HeadToHeadView,
    PointView,
    SeasonView,
)
from wildscav_leaderboard.presentation.season import (
    announcement_views,
    counts_view,
    season_view,
    validation_view,
)
from wildscav_leaderboard.seasons.refusals import NotFoundError, UnknownCallerError

router = APIRouter(tags=["boards"])
MOST_NUMBERS = 50  # submissions or teams of one answer


@router.get("/season")
def season(current: CurrentSeason, session: Reading) -> SeasonView:
    """Return the season: its dates, tracks, versions and announcements."""
    more = {"counts": counts_view(session), "validation": validation_view(session, current)}
    return season_view(session, current).model_copy(update=more)


@router.get("/boards")
def boards(current: CurrentSeason, session: Reading) -> list[BoardDocument]:
    """Return the boards of all tracks that have results."""
    found = (read_board(session, track) for track in current.settings.tracks)
    return [board for board in found if board is not None]


@router.get("/boards/{track}", response_model=BoardDocument)
def board(
    track: str,
    request: Request,
    current: CurrentSeason,
    session: Reading,
    caller: AnyProgram,
    audience: Literal["public", "hidden", "season"] = "public",
    edition: Number | None = None,
) -> Response:
    """Return the board of a track, or that of one of its earlier editions.

    The hidden one is for organizers. That of the season is as it was before final matches decided it.
    """
    if audience == HIDDEN:
        if caller is None:
            raise UnknownCallerError("only organizers see the hidden board: log in first")
        check_organizer(caller)
    if edition is None:
        current.track(track)
    found = kept_board(session, track, audience if edition is None else audience_of(edition))
    if found is None:
        raise NotFoundError(f"there are no results on {track} yet")
    tag = f"{audience}-{edition or 0}-{found.updated:%Y%m%d%H%M%S%f}"
    headers = {"ETag": f'"{tag}"', "Cache-Control": "private, no-cache"}
    if request.headers.get("if-none-match") == headers["ETag"]:
        return Response(status_code=304, headers=headers)
    return Response(found.json, media_type="application/json", headers=headers)


@router.get("/boards/{track}/history")
def points(
    track: str,
    current: CurrentSeason,
    session: Reading,
    caller: AnyProgram,
    submission: Annotated[list[Number], Query(max_length=MOST_NUMBERS)] = [],  # noqa: B006
    team: Annotated[list[str], Query(max_length=MOST_NUMBERS)] = [],  # noqa: B006
) -> list[PointView]:
    """Return how the places of some submissions or teams changed; while a board is frozen, until then."""
    current.track(track)
    until = shown_until(session, caller)
    found = point_views(history(session, track, submission, until)) if submission else []
    for name, changes in team_histories(session, track, team, until).items():
        found += point_views(changes, name)
    return found


@router.get("/boards/{track}/head-to-head")
def head_to_head(track: str, current: CurrentSeason, session: Reading) -> HeadToHeadView:
    """Return how the first entrants of a ladder did against each other."""
    current.track(track)
    return head_to_head_view(session, ladder_of(session, track))


@router.get("/announcements")
def announcements(session: Reading) -> list[AnnouncementView]:
    """Return what the organizers announced, the latest first."""
    return announcement_views(session)
