"""Boards: who leads, who beat whom and how the places changed, and the routes."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response
from sqlalchemy.orm import Session

from wildscav_evaluator.ratings.head_to_head import PairRecord
from wildscav_evaluator.seats import ROBOT_ENTRANT, robot_entrant
from wildscav_leaderboard.access.requests import AnyProgram, CurrentSeason, Number, Reading
from wildscav_leaderboard.api.documents import EntrantView, HeadToHeadView, OpponentView, PairView, PointView
from wildscav_leaderboard.api.match_views import robot_name, titled
from wildscav_leaderboard.boards import meetings
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard, LadderRow
from wildscav_leaderboard.boards.history import history, team_histories
from wildscav_leaderboard.boards.kept import kept_board, read_board
from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.seasons.editions import digest_of
from wildscav_leaderboard.seasons.refusals import NotFoundError
from wildscav_leaderboard.submissions.models import Submission, entrant_of
from wildscav_leaderboard.visibility import audience_for, shown_until

MAX_ENTRANTS = 24  # entrants of one table


def ladder_of(session: Session, track: str) -> LadderBoard:
    """Return the public board of a ladder.

    Raises:
        NotFoundError: The track has no ladder, or no results yet.
    """
    board = read_board(session, track)
    if not isinstance(board, LadderBoard):
        raise NotFoundError(f"nobody has met on a ladder of {track} yet")
    return board


def head_to_head_view(session: Session, board: LadderBoard) -> HeadToHeadView:
    """Return how the first entrants of a ladder did against each other, as far as its board counts."""
    rows = [row for row in board.rows if row.rank is not None][:MAX_ENTRANTS]
    names = [entrant_name(row) for row in rows]
    records = meetings.head_to_head(
        session, board.track, digest_of(board.conditions), names, applied=board.applied
    )
    return HeadToHeadView(
        track=board.track,
        entrants=[_entrant(name, row) for name, row in zip(names, rows, strict=True)],
        records=[
            PairView.about(record, first=first, second=second)
            for (first, second), record in sorted(records.items())
        ],
    )


def entrant_name(row: LadderRow) -> str:
    """Return the name under which the submission or robot of a row plays."""
    return robot_entrant(row.name) if row.submission is None else entrant_of(row.name, row.submission)


def _entrant(name: str, row: LadderRow) -> EntrantView:
    return EntrantView(
        entrant=name,
        name=row.name if row.submission is None else titled(row.name, row.version),
        submission=row.submission,
        team=row.team or None,
        title=row.team_title or row.name,
    )


def opponent_views(
    session: Session, tracks: Iterable[str], submission: Submission
) -> dict[str, list[OpponentView]]:
    """Return a submission's record against everyone whom it met, the most frequent first, on each ladder."""
    boards = {track: read_board(session, track) for track in tracks}
    ladders = [board for board in boards.values() if isinstance(board, LadderBoard)]
    if not ladders:
        return {}
    asked = [meetings.Ladder(one.track, digest_of(one.conditions), one.applied) for one in ladders]
    records = meetings.records_on(session, asked, submission.entrant)
    return {board.track: _opponents(board, records[board.track]) for board in ladders}


def _opponents(board: LadderBoard, records: Mapping[str, PairRecord]) -> list[OpponentView]:
    rows = {entrant_name(row): row for row in board.rows}
    ordered = sorted(records.items(), key=lambda one: (-one[1].count, one[0]))
    return [
        OpponentView.about(record, opponent=_entrant(name, rows[name]) if name in rows else _unlisted(name))
        for name, record in ordered
    ]


def _unlisted(entrant: str) -> EntrantView:
    """Return an entrant that has no row on the board: another submission of a team, or one that ended."""
    name, _, number = entrant.rpartition("-")
    if entrant.startswith(ROBOT_ENTRANT) or not number.isdecimal():
        robot = robot_name(entrant)
        return EntrantView(entrant=entrant, name=robot, submission=None, team=None, title=robot)
    return EntrantView(
        entrant=entrant, name=f"submission {number}", submission=int(number), team=None, title=name
    )


def point_views(points: Sequence[BoardPoint], team: str | None = None) -> list[PointView]:
    """Return points of the history of places."""
    return [PointView.about(point, team=team, submission=point.submission_id) for point in points]


def ranked_teams(board: BoardDocument | None, count: int) -> dict[str, str]:
    """Return the titles of the first teams of a board, by name."""
    rows = [] if board is None else [row for row in board.rows if row.rank is not None and row.team]
    return {row.team: row.team_title for row in rows[:count]}


router = APIRouter(tags=["boards"])
MAX_NUMBERS = 50  # submissions or teams of one answer


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
    if edition is None:
        current.track(track)
    found = kept_board(session, track, audience_for(caller, audience, edition))
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
    submission: Annotated[list[Number], Query(max_length=MAX_NUMBERS)] = [],  # noqa: B006
    team: Annotated[list[str], Query(max_length=MAX_NUMBERS)] = [],  # noqa: B006
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
