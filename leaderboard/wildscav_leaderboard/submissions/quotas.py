"""Quotas: how much a team may submit in a day, and how many of its submissions take part at once.

There are two counters. A team's own attempts count for its quota (``Submission.charged``); attempts that the
platform broke are counted apart (``Submission.platform_faults``), are retried, and are never charged.
"""

from collections.abc import Sequence
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.seasons.refusals import TooMuchError
from wildscav_leaderboard.seasons.settings import Quotas
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team


def check_day(session: Session, quotas: Quotas, team: Team, account: Account, now: datetime) -> None:
    """Check that a team, and an account in whatever team, may hand in another submission today.

    Raises:
        TooMuchError: The quota of one of them is used up.
    """
    counted_for = {
        "your team has": Submission.team_id == team.id,
        "you have, in this team and others,": Submission.account_id == account.id,
    }
    for who, is_of in counted_for.items():
        if used_today(session, is_of, now) >= quotas.per_day:
            raise TooMuchError(
                f"{who} used today's {counted(quotas.per_day, 'submission')}; the next day begins at "
                f"{day_after(now):%Y-%m-%d %H:%M} UTC"
            )


def used_today(session: Session, is_of: ColumnElement[bool], now: datetime) -> int:
    """Return how many charged submissions of somebody were handed in on this day, which is one of UTC."""
    wanted = select(func.count()).select_from(Submission).where(is_of, Submission.charged)
    return session.scalar(wanted.where(Submission.created >= day_after(now) - timedelta(days=1))) or 0


def day_after(now: datetime) -> datetime:
    """Return when the next day begins."""
    return now.replace(hour=0, minute=0, second=0, microsecond=0) + timedelta(days=1)


def active_of(session: Session, team_id: int) -> list[Submission]:
    """Return the submissions of a team that take part, the newest first."""
    wanted = select(Submission).filter_by(team_id=team_id, state=states.ACTIVE)
    return list(session.scalars(wanted.order_by(Submission.id.desc())))


def on_track(session: Session, team_id: int, track: str) -> list[Submission]:
    """Return the submissions of a team that take part on a track, the oldest first."""
    return [one for one in reversed(active_of(session, team_id)) if track in one.playing]


def _others(session: Session, submission: Submission, track: str) -> list[Submission]:
    return [one for one in on_track(session, submission.team_id, track) if one is not submission]


def tracks_with_room(session: Session, quotas: Quotas, submission: Submission) -> list[str]:
    """Return the tracks on which a submission may take part besides the others of its team."""
    return [one for one in submission.tracks if len(_others(session, submission, one)) < quotas.active]


def check_room(session: Session, quotas: Quotas, submission: Submission) -> None:
    """Check that a submission may take part on all of its tracks besides the others of its team.

    Raises:
        TooMuchError: Enough of them take part on one of its tracks; it names them.
    """
    for track in submission.tracks:
        others = _others(session, submission, track)
        if len(others) >= quotas.active:
            raise TooMuchError(f"{_full(quotas, track, others)}: disable one of them first")


def replaced_by(session: Session, quotas: Quotas, submission: Submission) -> list[tuple[str, Submission]]:
    """Return what leaves which track, as things are now, once a submission takes part: maybe itself.

    It is the one that the submission names, and else the oldest that is not kept.

    Raises:
        TooMuchError: All others are kept.
    """
    found: list[tuple[str, Submission]] = []
    for track in submission.tracks:
        others = _others(session, submission, track)
        surplus = len(others) + 1 - quotas.active
        named = [one for one in others if one.id == submission.replaces]
        free = [one for one in others if not one.kept and one not in named]
        free = sorted([*free, submission], key=lambda one: one.id)
        if surplus > 0 and not named and free == [submission]:
            raise TooMuchError(
                f"{_full(quotas, track, others)}, all of them kept: `wildscav team submissions release` one, "
                "or name the one to replace (`--replaces`)"
            )
        found += [(track, one) for one in (named + free)[: max(0, surplus)]]
    return found


def _full(quotas: Quotas, track: str, others: Sequence[Submission]) -> str:
    numbers = ", ".join(str(one.id) for one in others)
    return f"{counted(quotas.active, 'submission')} of a team may take part on {track}, and {numbers} do"
