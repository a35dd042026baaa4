"""How places on boards changed. While boards are frozen, their history ends then, except for organizers."""

from collections.abc import Collection, Iterable
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team


def history(
    session: Session, track: str, submissions: Iterable[int], until: datetime | None = None
) -> list[BoardPoint]:
    """Return how the places of some submissions changed, in the order of time.

    Args:
        until: What came later is left out; None for everything.
    """
    wanted = select(BoardPoint).where(BoardPoint.submission_id.in_(list(submissions)))
    return list(session.scalars(_in_order(wanted.where(BoardPoint.track == track), until)))


def histories_of(
    session: Session, owner: Submission | Team, until: datetime | None = None
) -> dict[str, list[BoardPoint]]:
    """Return how the places of a submission or a team changed on each track, in the order of time."""
    wanted = select(BoardPoint).join(Submission, Submission.id == BoardPoint.submission_id)
    column = Submission.team_id if isinstance(owner, Team) else Submission.id
    found: dict[str, list[BoardPoint]] = {}
    for point in session.scalars(_in_order(wanted.where(column == owner.id), until)):
        found.setdefault(point.track, []).append(point)
    return found


def team_histories(
    session: Session, track: str, teams: Collection[str], until: datetime | None = None
) -> dict[str, list[BoardPoint]]:
    """Return how the places of some teams changed, by the name of the team, in the order of time.

    Args:
        until: What came later is left out; None for everything.
    """
    wanted = (
        select(BoardPoint, Team.name)
        .join(Submission, Submission.id == BoardPoint.submission_id)
        .join(Team, Team.id == Submission.team_id)
        .where(Team.name.in_(list(teams)))
    )
    found: dict[str, list[BoardPoint]] = {name: [] for name in teams}
    for point, name in session.execute(_in_order(wanted.where(BoardPoint.track == track), until)):
        found[name].append(point)
    return found


def latest_points(
    session: Session, track: str, count: int, until: datetime | None = None
) -> list[tuple[BoardPoint, Submission, Team]]:
    """Return the latest changes of places on a track, the latest first."""
    wanted = (
        select(BoardPoint, Submission, Team)
        .join(Submission, Submission.id == BoardPoint.submission_id)
        .join(Team, Team.id == Submission.team_id)
        .where(BoardPoint.track == track, *_before(until))
        .order_by(BoardPoint.id.desc())
        .limit(count)
    )
    return [(point, submission, team) for point, submission, team in session.execute(wanted)]


def _in_order(wanted: Any, until: datetime | None) -> Any:  # of one type: a Select
    chosen = wanted.where(*_before(until))
    return chosen.order_by(BoardPoint.at, BoardPoint.id)


def _before(until: datetime | None) -> list[ColumnElement[bool]]:
    return [] if until is None else [BoardPoint.at <= until]
