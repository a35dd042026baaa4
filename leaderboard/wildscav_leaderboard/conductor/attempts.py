"""Attempts at work: when each began and how it ended. Whatever never ended is lost, and is tried again."""

from collections.abc import Sequence
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, func, or_, select, update
from sqlalchemy.orm import Session

from wildscav_leaderboard.conductor.lease import Holding
from wildscav_leaderboard.conductor.models import PLAY, Attempt

DONE, AGENT, PLATFORM, LOST = "done", "agent", "platform", "lost"  # outcomes
RETURNED = "returned"  # it had not begun when its conductor ended, or that was stopped in order
FORGIVEN = "forgiven"  # lost, before organizers had the work tried again
MAX_LOST = 10  # attempts at one piece of work; whatever takes the conductor with it every time is given up


def begin(
    session: Session,
    kind: str,
    holding: Holding,
    now: datetime,
    lasts: float,
    *,
    submission: int | None = None,
    match: int | None = None,
) -> Attempt:
    """Begin an attempt.

    Args:
        session: A writing session.
        lasts: How long it may take, s.
        submission: The submission that it is about, if it is one.
        match: The match that it is about, if it is one.
    """
    work = {"kind": kind, "submission_id": submission, "match_id": match}
    before = session.scalar(select(func.count()).select_from(Attempt).filter_by(**work))
    attempt = Attempt(
        kind=kind,
        number=(before or 0) + 1,
        epoch=holding.epoch,
        started=now,
        deadline=now + timedelta(seconds=lasts),
        submission_id=submission,
        match_id=match,
        begun=None if kind == PLAY else now,
    )
    session.add(attempt)
    session.flush()
    return attempt


def end(attempt: Attempt, outcome: str, now: datetime, detail: str = "") -> bool:
    """End an attempt; return False if it had ended before, so that its news is old."""
    if attempt.ended is not None:
        return False
    attempt.ended, attempt.outcome, attempt.detail = now, outcome, detail
    return True


def overdue(session: Session, holding: Holding, now: datetime) -> list[Attempt]:
    """Return the attempts that have not ended and never will: of other conductors, or past their deadline."""
    wanted = select(Attempt).where(
        Attempt.ended.is_(None), or_(Attempt.epoch != holding.epoch, Attempt.deadline <= now)
    )
    return list(session.scalars(wanted.order_by(Attempt.id)))


def running(session: Session) -> list[Attempt]:
    """Return the attempts that have not ended."""
    return list(session.scalars(select(Attempt).where(Attempt.ended.is_(None)).order_by(Attempt.id)))


def matches_begun(session: Session) -> int:
    """Return how many matches are being played."""
    playing = select(func.count()).where(Attempt.ended.is_(None), Attempt.begun.is_not(None))
    return session.scalar(playing.where(Attempt.kind == PLAY)) or 0


def losses(session: Session, attempt: Attempt) -> int:
    """Return how many attempts at the same work were lost."""
    work = {"kind": attempt.kind, "submission_id": attempt.submission_id, "match_id": attempt.match_id}
    return session.scalar(select(func.count()).select_from(Attempt).filter_by(**work, outcome=LOST)) or 0


def forgive_submission(session: Session, submission: int) -> None:
    """Count no attempt at a submission as lost any more, because it is tried again from the start."""
    _forgive(session, Attempt.submission_id == submission)


def forgive_matches(session: Session, matches: Sequence[int]) -> None:
    """Count no attempt at some matches as lost any more, because they are played again."""
    _forgive(session, Attempt.match_id.in_(matches))


def _forgive(session: Session, work: ColumnElement[bool]) -> None:
    session.execute(update(Attempt).where(Attempt.outcome == LOST, work).values(outcome=FORGIVEN))
