"""Lists of submissions, and what may be seen of one."""

from collections.abc import Sequence

from sqlalchemy import ColumnElement, or_, select, true
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.database.connection import once
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import ACTIVE, CANCELLED, FAILED
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import team_of

MAX_LISTED = 100  # in one list


def list_submissions(
    session: Session,
    *,
    team: int | None = None,
    states: Sequence[str] = (),
    before: int | None = None,
    limit: int = MAX_LISTED,
    where: ColumnElement[bool] | None = None,
) -> list[Submission]:
    """Return submissions, the newest first."""
    wanted = select(Submission).order_by(Submission.id.desc()).limit(limit)
    if where is not None:
        wanted = wanted.where(where)
    if team is not None:
        wanted = wanted.where(Submission.team_id == team)
    if states:
        wanted = wanted.where(Submission.state.in_(states))
    if before is not None:
        wanted = wanted.where(Submission.id < before)
    return list(session.scalars(wanted))


def listed_for(session: Session, caller: Caller | None) -> ColumnElement[bool]:
    """Return which submissions are in lists: of other teams, none that failed or were cancelled."""
    if caller is not None and caller.is_organizer:
        return true()
    team = None if caller is None else team_of(session, caller.account)
    shown = Submission.state.not_in((FAILED, CANCELLED))
    return shown if team is None else or_(shown, Submission.team_id == team.id)


def taking_part(session: Session, track: str) -> list[tuple[Submission, Team]]:
    """Return the submissions that take part on a track, the oldest first, with their teams."""
    wanted = (
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.state == ACTIVE, Team.disqualified.is_(None))
        .order_by(Submission.id)
    )
    return [(one, team) for one, team in session.execute(wanted) if track in one.playing]


def team_names(session: Session, submissions: Sequence[Submission]) -> dict[int, Team]:
    """Return the teams of some submissions, by number."""
    found = once(session, Team, dict[int, Team])
    missing = {one.team_id for one in submissions} - found.keys()
    if missing:
        found |= {team.id: team for team in session.scalars(select(Team).where(Team.id.in_(missing)))}
    return found


def is_own(session: Session, caller: Caller | None, submission: Submission) -> bool:
    """Return whether a submission is of the caller's team, or the caller is an organizer."""
    if caller is None:
        return False
    team = team_of(session, caller.account)
    return caller.is_organizer or (team is not None and team.id == submission.team_id)
