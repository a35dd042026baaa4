"""Quotas: how much a team may submit in a day, and how many of its submissions take part at once.

There are two counters. A team's own attempts count for its quota (``Submission.charged``); attempts that the
platform broke are counted apart (``Submission.platform_faults``), are retried, and are never charged.
"""

from collections import Counter
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_leaderboard.seasons.refusals import TooMuchError
from wildscav_leaderboard.seasons.settings import Quotas
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team


@dataclass(frozen=True)
class QuotaView:
    """What a team has used of its quota."""

    per_day: int
    used_today: int
    resets: datetime  # when the day ends
    active_per_track: int
    active: dict[str, int]  # by track

    @property
    def left_today(self) -> int:
        """How many submissions the team may hand in before the day ends."""
        return max(0, self.per_day - self.used_today)


def quota_of(session: Session, quotas: Quotas, team: Team, now: datetime) -> QuotaView:
    """Return what a team has used of its quota. A day is one of UTC."""
    start = now.replace(hour=0, minute=0, second=0, microsecond=0)
    used = session.scalar(
        select(func.count())
        .select_from(Submission)
        .where(Submission.team_id == team.id, Submission.created >= start, Submission.charged)
    )
    active = Counter(track for one in active_of(session, team.id) for track in one.tracks)
    return QuotaView(quotas.per_day, used or 0, start + timedelta(days=1), quotas.active, dict(active))


def check_day(session: Session, quotas: Quotas, team: Team, now: datetime) -> None:
    """Check that a team may hand in another submission today.

    Raises:
        TooMuchError: Its quota is used up.
    """
    quota = quota_of(session, quotas, team, now)
    if quota.left_today == 0:
        raise TooMuchError(
            f"your team has used today's {counted(quota.per_day, 'submission')}; the next day begins at "
            f"{quota.resets:%Y-%m-%d %H:%M} UTC"
        )


def active_of(session: Session, team_id: int) -> list[Submission]:
    """Return the submissions of a team that take part, the newest first."""
    wanted = select(Submission).filter_by(team_id=team_id, state=states.ACTIVE)
    return list(session.scalars(wanted.order_by(Submission.id.desc())))


def check_room(session: Session, quotas: Quotas, submission: Submission) -> None:
    """Check that a submission may take part besides the others of its team.

    Raises:
        TooMuchError: Enough of them take part on one of its tracks; it names them.
    """
    others = active_of(session, submission.team_id)
    for track in submission.tracks:
        numbers = [str(one.id) for one in others if track in one.tracks]
        if len(numbers) >= quotas.active:
            raise TooMuchError(
                f"{counted(quotas.active, 'submission')} of your team may take part on {track} at once, and "
                f"{', '.join(numbers)} already do: disable one of them first"
            )


def surplus(session: Session, quotas: Quotas, team_id: int) -> list[Submission]:
    """Return the active submissions of a team that newer ones replace on every one of their tracks."""
    newer: Counter[str] = Counter()
    replaced = []
    for submission in active_of(session, team_id):
        if all(newer[track] >= quotas.active for track in submission.tracks):
            replaced.append(submission)
        newer.update(submission.tracks)
    return replaced
