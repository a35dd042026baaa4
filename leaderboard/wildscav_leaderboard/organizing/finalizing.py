"""Deciding a season: what was handed in is played to its end, and the best play again on seeds of their own.

Whoever submits often, and looks at the board each time, fits an agent to the matches of the season a little,
whether that is wanted or not. So the best submissions of each suite play the same number of matches again, on
the seeds of the second secret, on which nobody has played; these matches alone decide. Ladders
have final rounds (``final_rounds.py``).

Each step is one transaction that finds out by itself what is to be done next. So it may be interrupted at
any moment, and begun again.
"""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards import service as boards
from wildscav_leaderboard.boards.conditions import conditions_of
from wildscav_leaderboard.boards.documents import digest_of
from wildscav_leaderboard.boards.final import Final
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import HIDDEN
from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.conductor.plans import ladders_want_matches
from wildscav_leaderboard.database.connection import clock
from wildscav_leaderboard.matches.models import (
    FINAL,
    FINISHED,
    LADDER,
    PLAYING,
    VOID,
    WAITING,
    Match,
    MatchResult,
)
from wildscav_leaderboard.matches.service import add_suite_matches
from wildscav_leaderboard.organizing import final_rounds
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.state import log_act
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission

SETTLING, DECIDING, DONE = "settling", "deciding", "done"  # stages
PENDING = (states.SUBMITTED, states.QUEUED, states.BUILDING, states.VALIDATING)


@dataclass(frozen=True)
class Progress:
    """How far a season is on the way to its end."""

    stage: str
    played: int = 0  # matches of this stage
    planned: int = 0
    pending: int = 0  # submissions that are not validated yet
    note: str = ""  # why it does not go on


def begin(session: Session, season: Season, actor: str, best: int, now: datetime, *, early: bool) -> None:
    """Begin to decide the season, unless that was begun before: submissions are no longer accepted.

    Args:
        session: A writing session.
        season: The season.
        actor: Who wants it.
        best: How many submissions of each suite play the matches that decide it, at most; a final round of a
            ladder has everyone who may be among so many.
        now: The time.
        early: Whether it may begin before the season closes.

    Raises:
        RefusalError: The season is still open.
    """
    if season_state.read_state(session, season_state.FINALIZING) is not None:
        return
    if now < season.settings.closes and not early:
        closes = f"{season.settings.closes:%Y-%m-%d %H:%M} UTC"
        raise RefusalError(f"the season is open until {closes}; --now ends it at once")
    value: dict[str, Any] = {"at": now.isoformat(), "best": best, "field": None}
    season_state.write_state(session, season_state.FINALIZING, value, now)
    log_act(session, actor, "finalize", "season", now, f"the best {best} of each track play again")


def advance(session: Session, season: Season, actor: str, now: datetime) -> Progress:
    """Do what can be done now, and return how far the season is.

    Args:
        session: A writing session.
        season: The season, whose end was begun.
        actor: Who wants it.
        now: The time.

    Raises:
        RefusalError: It cannot go on before the organizers do something about it.
    """
    if season_state.read_state(session, season_state.FINALIZED) is not None:
        return Progress(DONE)
    state = season_state.read_state(session, season_state.FINALIZING)
    if state is None:
        raise RefusalError("the season is not being decided")
    if state["field"] is None:
        settling = _settling(session, season)
        if settling is not None:
            return settling
        state = _choose_field(session, season, state, now)
    deciding = _deciding(session, season, state["field"])
    if deciding is not None:
        return deciding
    _decide(session, season, state["field"], actor, now)
    return Progress(DONE)


def _settling(session: Session, season: Season) -> Progress | None:
    """Return how far what was handed in is played; None if it is."""
    pending = _count(session, select(func.count()).where(Submission.state.in_(PENDING)))
    left = _count(session, select(func.count()).where(Match.state.in_((WAITING, PLAYING))))
    if not pending and not left and not ladders_want_matches(session, season):
        return None
    planned = _count(session, select(func.count()).where(Match.state != VOID))
    return Progress(SETTLING, planned - left, planned, pending, _why_it_stands(session))


def _choose_field(session: Session, season: Season, state: dict[str, Any], now: datetime) -> dict[str, Any]:
    """Choose who plays the matches that decide each suite, and plan them."""
    boards.refresh(session, season, _sandbox(session, season), now)
    field: dict[str, list[int]] = {}
    for track, specs in season.final_matches.items():
        board = read_board(session, track, HIDDEN)
        ranked = [] if board is None else [row for row in board.rows if row.rank is not None]
        field[track] = [row.submission for row in ranked[: state["best"]] if row.submission is not None]
        for number in field[track]:
            submission = session.get_one(Submission, number)
            add_suite_matches(session, submission, track, specs, now, FINAL)
    chosen = {**state, "field": field | final_rounds.fields_of(session, season, state["best"])}
    season_state.write_state(session, season_state.FINALIZING, chosen, now)
    return chosen


def _deciding(session: Session, season: Season, field: dict[str, list[int]]) -> Progress | None:
    """Return how far the matches that decide the season are; None if they are played.

    Raises:
        RefusalError: Some were given up.
    """
    playing = _active(session, field)
    own = select(func.count()).where(Match.kind == FINAL, Match.group_id.in_(playing))
    given_up = session.scalars(
        select(Match.group_id)
        .where(Match.kind == FINAL, Match.group_id.in_(playing), Match.state == VOID)
        .distinct()
    ).all()
    if given_up:
        numbers = ", ".join(map(str, sorted(given_up)))
        raise RefusalError(
            f"final matches of {numbers} were given up after faults of the platform: find out why "
            "(`wildscav season status`), and have them played again (`wildscav season rerun`)"
        )
    rounds = select(func.count()).where(Match.decides, Match.kind == LADDER, Match.state != VOID)
    planned = _count(session, own) + _count(session, rounds)
    played = sum(_count(session, one.where(Match.state == FINISHED)) for one in (own, rounds))
    is_over = played == planned and not ladders_want_matches(session, season)
    return None if is_over else Progress(DECIDING, played, planned, 0, _why_it_stands(session))


def _active(session: Session, field: dict[str, list[int]]) -> list[int]:
    """Return those of the field that still take part."""
    numbers = {number for one in field.values() for number in one}
    wanted = select(Submission.id).where(Submission.id.in_(numbers), Submission.state == states.ACTIVE)
    return list(session.scalars(wanted))


def _decide(session: Session, season: Season, field: dict[str, list[int]], actor: str, now: datetime) -> None:
    """Make the boards final, and open the secrets: all at once, or nothing.

    Raises:
        RefusalError: Final matches were played under different conditions.
    """
    sandbox = _sandbox(session, season)
    field = final_rounds.decided_by(session, season, field)
    conditions = {
        track: conditions_of(season, track, sandbox, final=track in field) for track in season.settings.tracks
    }
    for track in field:
        _check_conditions(session, track, digest_of(conditions[track]))
    final = Final({track: frozenset(one) for track, one in field.items()}, conditions)
    boards.decide(session, season, final, now)
    secrets = {
        name: (season.folder / file).read_bytes().decode("ascii", "replace")
        for name, file in (("secret", SECRET_FILE), ("final_secret", FINAL_SECRET_FILE))
    }
    season_state.write_state(session, season_state.OPENED, secrets, now)
    log_act(session, actor, "decide", "season", now, "the boards are final, and the secrets are opened")


def _check_conditions(session: Session, track: str, digest: str) -> None:
    others = _count(
        session,
        select(func.count())
        .select_from(Match)
        .join(MatchResult, MatchResult.match_id == Match.id)
        .where(Match.decides, Match.track == track, MatchResult.conditions != digest),
    )
    if others:
        raise RefusalError(
            f"{others:,} of the final matches of {track} were played with another sandbox or version of "
            "Wildscav than there is now, so they cannot be compared: run what played them again"
        )


def _why_it_stands(session: Session) -> str:
    """Return why nothing is being played; an empty text if something is."""
    paused = season_state.read_state(session, season_state.PAUSED)
    if paused is not None:
        return f"the season is paused: {paused['reason']}"
    if holder_of(session, clock(session)) is None:
        return "nobody plays the matches: `wildscav season serve` starts what does"
    return ""


def _sandbox(session: Session, season: Season) -> str:
    """Return the sandbox in which the matches were played."""
    nodes = season_state.read_state(session, season_state.NODES) or {}
    return str(nodes.get("sandbox") or season.settings.execution.sandbox or "process")


def _count(session: Session, counting: Any) -> int:
    return session.scalar(counting) or 0
