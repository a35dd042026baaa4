"""The queue of submissions that wait to be built and validated: whose turn it is, and how long it takes."""

import math
from collections import Counter
from datetime import datetime
from statistics import fmean

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission, Transition

FIRST_GUESS = 60.0  # s that a submission takes, before any has been seen
RECENT = 20  # submissions from which the expected wait is computed


def queue(session: Session) -> list[Submission]:
    """Return the submissions that wait, in the order in which they are taken.

    Each team's first one comes before any team's second one, so that a team that submits much delays nobody
    but itself.
    """
    wanted = select(Submission).where(Submission.state.in_((states.SUBMITTED, states.QUEUED)))
    waiting = list(session.scalars(wanted.order_by(Submission.id)))
    turns: Counter[int] = Counter()
    keyed = []
    for submission in waiting:
        keyed.append((turns[submission.team_id], submission.id, submission))
        turns[submission.team_id] += 1
    return [submission for _, _, submission in sorted(keyed, key=lambda one: one[:2])]


def expected_wait(
    submission: Submission, position: int | None, each: float, at_once: int, now: datetime
) -> float | None:
    """Return how long it will take until a submission is active or has failed, s; None if it has ended.

    Args:
        position: Its place in the queue, 1 for the next one; None if it does not wait.
        each: How long recent ones took, s.
        at_once: How many are built and validated at once: it waits as long as they need in turns.
    """
    if submission.state in (states.BUILDING, states.VALIDATING):
        return max(0.0, each - (now - submission.since).total_seconds())
    return None if position is None else math.ceil(position / at_once) * each


def validations(session: Session) -> int:
    """Return how many submissions the conductor builds and validates at once."""
    return int((season_state.read_state(session, season_state.NODES) or {}).get("validations", 1))


def mean_time(session: Session) -> float:
    """Return how long recent submissions took from the start of their building to their end, s."""
    ends = (
        select(Transition.id, Transition.submission_id, Transition.at)
        .where(Transition.state.in_((states.ACTIVE, states.FAILED)))
        .order_by(Transition.id.desc())
        .limit(RECENT)
        .subquery()
    )
    wanted = (
        select(ends.c.id, Transition.at, ends.c.at)
        .join(Transition, Transition.submission_id == ends.c.submission_id)
        .where(Transition.state == states.BUILDING)
        .order_by(Transition.id)
    )
    spans = {end: (begun, ended) for end, begun, ended in session.execute(wanted)}  # of the last attempts
    times = [(ended - begun).total_seconds() for begun, ended in spans.values() if ended >= begun]
    return fmean(times) if times else FIRST_GUESS
