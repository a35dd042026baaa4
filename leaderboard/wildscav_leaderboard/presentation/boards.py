"""What is shown beside a board: who beat whom, how the places changed, and what is new."""

from collections.abc import Iterable, Mapping, Sequence

from sqlalchemy.orm import Session

from wildscav_evaluator.ratings.head_to_head import PairRecord
from wildscav_evaluator.seats import ROBOT_ENTRANT, robot_entrant
from wildscav_leaderboard.boards import meetings
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard, LadderRow
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.presentation.documents import (
    EntrantView,
    HeadToHeadView,
    OpponentView,
    PairView,
    PointView,
)
from wildscav_leaderboard.presentation.matches import robot_name, titled
from wildscav_leaderboard.seasons.editions import digest_of
from wildscav_leaderboard.seasons.refusals import NotFoundError
from wildscav_leaderboard.submissions.models import Submission, entrant_of

MOST = 24  # entrants of one table


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
    rows = [row for row in board.rows if row.rank is not None][:MOST]
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
