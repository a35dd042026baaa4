"""The steps of the conductor: what it decides, each in one short transaction that may be repeated.

None of them does any work itself. What they hand out is done by ``work.py``, and comes back here; it may
come back late, twice, or never.
"""

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.results import MatchRow, MatchTiming, metric_infos
from wildscav_leaderboard.boards.service import after_boards
from wildscav_leaderboard.conductor import attempts
from wildscav_leaderboard.conductor.lease import Holding, check
from wildscav_leaderboard.conductor.models import BUILD, PLAY, VALIDATE, Attempt
from wildscav_leaderboard.conductor.plans import is_playable, plan_suites
from wildscav_leaderboard.matches import service as matches
from wildscav_leaderboard.matches.models import PLAYING, Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.submissions.service import PLATFORM, activate, move

CONDUCTOR = "the conductor"  # the actor of what nobody did; no account can be called so


def admit(session: Session, now: datetime) -> None:
    """Put submissions that were handed in into the queue."""
    for submission in session.scalars(select(Submission).filter_by(state=states.SUBMITTED)).all():
        move(session, submission, states.QUEUED, now)


def freeze_when_due(session: Session, season: Season, now: datetime) -> bool:
    """Freeze the public boards once at the time that the settings name; return whether that changed anything.

    If that time is moved into the future afterwards, the boards go on until then.
    """
    due, frozen = season.settings.freezes, season_state.read_state(session, season_state.FROZEN)
    if season_state.is_finalized(session):
        return False
    if due is not None and now >= due:
        if not season_state.freeze(session, now, due):
            return False
        verb, detail = "freeze", f"due at {due:%Y-%m-%d %H:%M} UTC"
    elif frozen is not None and frozen.get("due") is not None:
        season_state.write_state(session, season_state.FROZEN, None, now)
        verb, detail = "unfreeze", "the time of the freeze was moved"
    else:
        return False
    season_state.log_act(session, CONDUCTOR, verb, "boards", now, detail)
    return True


def take_submission(session: Session, season: Season, holding: Holding, now: datetime) -> Attempt | None:
    """Begin to build the submission whose turn it is; return None if none waits."""
    check(session, holding)
    waiting = [one for one in queue(session) if one.state == states.QUEUED]
    if not waiting or season_state.is_paused(session):
        return None
    lasts = season.settings.deadlines.building
    attempt = attempts.begin(session, BUILD, holding, now, lasts, submission=waiting[0].id)
    move(session, waiting[0], states.BUILDING, now, deadline=attempt.deadline)
    return attempt


def built(
    session: Session, season: Season, holding: Holding, attempt_id: int, now: datetime
) -> Attempt | None:
    """Go on from building to validating; return None if the attempt is no longer wanted."""
    check(session, holding)
    submission = _ended(session, attempt_id, attempts.DONE, now, states.BUILDING)
    if submission is None:
        return None
    lasts = season.settings.deadlines.validating
    attempt = attempts.begin(session, VALIDATE, holding, now, lasts, submission=submission.id)
    move(session, submission, states.VALIDATING, now, deadline=attempt.deadline)
    return attempt


def validated(
    session: Session, season: Season, holding: Holding, attempt_id: int, now: datetime, warnings: str = ""
) -> bool:
    """Let a submission that passed its validation take part; return False if it is no longer wanted."""
    check(session, holding)
    submission = _ended(session, attempt_id, attempts.DONE, now, states.VALIDATING)
    if submission is None:
        return False
    for track, replaced in activate(session, season, submission, now, warnings):
        matches.withdraw(session, replaced, now, track)
    if submission.state == states.ACTIVE:  # else newer ones came before it, and it is replaced already
        plan_suites(session, season, submission, now)
    return True


def rejected(
    session: Session,
    holding: Holding,
    attempt_id: int,
    now: datetime,
    *,
    reason: str,
    last_lines: Sequence[str] = (),
    command: str = "",
) -> bool:
    """Let a submission fail by its own fault; return False if it is no longer wanted."""
    check(session, holding)
    attempt = session.get_one(Attempt, attempt_id)
    state = states.BUILDING if attempt.kind == BUILD else states.VALIDATING
    submission = _ended(session, attempt_id, attempts.AGENT, now, state, reason)
    if submission is None:
        return False
    move(
        session,
        submission,
        states.FAILED,
        now,
        fault="agent",
        reason=reason,
        last_lines=last_lines,
        command=command,
    )
    return True


def _ended(
    session: Session, attempt_id: int, outcome: str, now: datetime, state: str, detail: str = ""
) -> Submission | None:
    """End an attempt, and return its submission if it is still in the state of that work."""
    attempt = session.get_one(Attempt, attempt_id)
    if not attempts.end(attempt, outcome, now, detail) or attempt.submission_id is None:
        return None
    submission = session.get_one(Submission, attempt.submission_id)
    return submission if submission.state == state else None


def take_matches(
    session: Session, season: Season, holding: Holding, now: datetime, count: int
) -> list[tuple[Attempt, Match]]:
    """Begin to play the next matches, at most ``count``."""
    check(session, holding)
    if season_state.is_paused(session):
        return []
    taken, season = [], in_force(session, season)
    played = {
        track: season.numbers.get(track)
        for track in season.settings.tracks
        if is_playable(session, season, track)
    }
    for match in matches.next_matches(session, played, count):
        if not matches.takes_part(session, match):
            matches.void(match, now, f"{matches.WITHDRAWN}a submission of it no longer takes part")
            continue
        lasts = season.clock(match.track).deadline(MatchSpec.model_validate(match.spec))
        attempt = attempts.begin(session, PLAY, holding, now, lasts, match=match.id)
        matches.mark_playing(match, now, attempt.deadline)
        taken.append((attempt, match))
    return taken


def begun(session: Session, holding: Holding, attempt_id: int, now: datetime) -> bool:
    """Note that a match that was taken begins now; return False if it does not: the season is paused."""
    check(session, holding)
    attempt = session.get_one(Attempt, attempt_id)
    match = session.get_one(Match, attempt.match_id)
    if attempt.ended is not None or match.state != PLAYING:
        return True
    if attempt.begun is None and season_state.is_paused(session):
        attempts.end(attempt, attempts.RETURNED, now, "the season is paused")
        matches.mark_waiting(session, match, now)
        return False
    attempt.begun = match.since = now
    return True


def played(
    session: Session,
    holding: Holding,
    attempt_id: int,
    row: MatchRow,
    timing: MatchTiming,
    record: matches.PlayedRecord,
    now: datetime,
) -> bool:
    """Store the result of a match; return False if it is no longer wanted."""
    check(session, holding)
    attempt = session.get_one(Attempt, attempt_id)
    attempts.end(attempt, attempts.DONE, now)
    match = session.get_one(Match, attempt.match_id)
    # A late result of an earlier attempt is as good as any: the first to arrive stays.
    metric, arrived = metric_infos(match.track)[0], after_boards(session, now)
    return matches.deliver(session, match, attempt.id, row, timing, record, metric, arrived)


def broke(
    session: Session, season: Season, holding: Holding, attempt_id: int, now: datetime, detail: str
) -> bool:
    """Note that the platform broke an attempt, and plan another one; return False if it is old news."""
    check(session, holding)
    attempt = session.get_one(Attempt, attempt_id)
    if not attempts.end(attempt, attempts.PLATFORM, now, detail):
        return False
    _again(session, season, attempt, now, detail, is_fault=True)
    return True


def expire(session: Session, season: Season, holding: Holding, now: datetime) -> int:
    """Try again what never ended; return how many attempts were lost."""
    check(session, holding)
    lost = attempts.overdue(session, holding, now)
    for attempt in lost:
        late = attempt.epoch == holding.epoch and attempt.begun is not None
        why = "it did not end before its deadline" if late else "its conductor ended"
        attempts.end(attempt, attempts.RETURNED if attempt.begun is None else attempts.LOST, now, why)
        session.flush()
        _again(session, season, attempt, now, why, is_fault=late)
    return len(lost)


def hand_back(session: Session, season: Season, holding: Holding, now: datetime) -> None:
    """Let everything wait again that has not ended, since the conductor is being stopped: no fault."""
    check(session, holding)
    for attempt in attempts.running(session):
        attempts.end(attempt, attempts.RETURNED, now, "its conductor was stopped")
        _again(session, season, attempt, now, "the conductor was stopped", is_fault=False)


def _again(
    session: Session, season: Season, attempt: Attempt, now: datetime, why: str, *, is_fault: bool
) -> None:
    """Plan another attempt at a piece of work, or give it up as the platform's fault."""
    most = season.settings.deadlines.attempts
    if attempt.match_id is not None:
        match = session.get_one(Match, attempt.match_id)
        match.platform_faults += is_fault
        if match.state == PLAYING:
            if _given_up(session, attempt, match.platform_faults, most):
                matches.void(match, now, f"given up after {attempt.number} attempts: {why}")
            else:
                matches.mark_waiting(session, match, now)
        return
    submission = session.get_one(Submission, attempt.submission_id)
    submission.platform_faults += is_fault
    if submission.state not in (states.BUILDING, states.VALIDATING):
        return
    if _given_up(session, attempt, submission.platform_faults, most):
        move(session, submission, states.FAILED, now, fault=PLATFORM, reason=why)
    else:
        move(session, submission, states.QUEUED, now, detail=why)


def _given_up(session: Session, attempt: Attempt, faults: int, most: int) -> bool:
    return faults >= most or attempts.losses(session, attempt) >= attempts.MAX_LOST
