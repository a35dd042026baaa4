"""Deciding a season: what was handed in is played to its end, and the best play again on seeds of their own.

Whoever submits often, and looks at the board each time, fits an agent to the matches of the season a little,
whether that is wanted or not. So the best submissions of each suite play the same number of matches again, on
the seeds of the second secret, on which nobody has played; these matches alone decide.

On ladders everyone who may be among the best plays a final round: another ladder with the same rules, on
games of the second secret. It decides alone, so whoever was lucky in the season, or tried many submissions
until one was, is as likely to lead it as an equal. A ladder on which nobody can meet is decided by its
matches of the season.

Each step is one transaction that finds out by itself what is to be done next. So it may be interrupted at
any moment, and begun again.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, and_, false, func, or_, select, update
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards import service as boards
from wildscav_leaderboard.boards.kept import read_board
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
    MatchSeat,
)
from wildscav_leaderboard.matches.service import WITHDRAWN, add_suite_matches, are_in_force
from wildscav_leaderboard.organizing.arguments import LONGEST_REASON
from wildscav_leaderboard.organizing.checking import wrong_secrets
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.in_force import in_force, model_of, sandbox_of
from wildscav_leaderboard.seasons.names import checked_line
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.state import log_act
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import find_submission
from wildscav_leaderboard.visibility import HIDDEN

SETTLING, DECIDING, DONE = "settling", "deciding", "done"  # stages
PENDING = (states.SUBMITTED, states.QUEUED, states.BUILDING, states.VALIDATING)


@dataclass(frozen=True)
class Ending:
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
        actor: Who wants it.
        best: How many submissions of each suite play the matches that decide it, at most; a final round of a
            ladder has everyone who may be among so many.
        early: Whether it may begin before the season closes.

    Raises:
        RefusalError: The season is still open.
    """
    if season_state.read_state(session, season_state.FINALIZING) is not None:
        return
    for problem in wrong_secrets(season.folder):
        raise RefusalError(problem)
    if now < season.settings.closes and not early:
        closes = f"{season.settings.closes:%Y-%m-%d %H:%M} UTC"
        raise RefusalError(f"the season is open until {closes}; --now ends it at once")
    value: dict[str, Any] = {"at": now.isoformat(), "best": best, "field": None}
    season_state.write_state(session, season_state.FINALIZING, value, now)
    log_act(session, actor, "finalize", "season", now, f"the best {best} of each track play again")


def abort(session: Session, actor: str, now: datetime) -> None:
    """Take back that the season is to be decided: what is not played yet of its final matches is withdrawn.

    Raises:
        RefusalError: It is not being decided, or it is decided already.
    """
    if season_state.is_finalized(session):
        raise RefusalError("the season is over, and its secrets are opened: that cannot be taken back")
    if season_state.read_state(session, season_state.FINALIZING) is None:
        raise RefusalError("the season is not being decided")
    for name in (season_state.FINALIZING, season_state.LEFT_OUT):
        season_state.write_state(session, name, None, now)
    withdrawn = {"state": VOID, "since": now, "detail": f"{WITHDRAWN}the end of the season was taken back"}
    session.execute(update(Match).where(Match.decides, Match.state == WAITING).values(withdrawn))
    log_act(session, actor, "abort finalize", "season", now)


def finalize_again(session: Session, season: Season, actor: str, now: datetime) -> bool:
    """Make the final boards anew if the season is decided, without who is disqualified since.

    Returns:
        Whether it is decided, so that what was published is to be replaced.
    """
    if not season_state.is_finalized(session):
        return False
    changed = ", ".join(boards.refresh(session, season, now)) or "nothing"
    log_act(session, actor, "finalize again", "season", now, f"published anew; changed: {changed}")
    return True


def advance(session: Session, season: Season, actor: str, now: datetime) -> Ending:
    """Do what can be done now, and return how far the season is.

    Args:
        session: A writing session.
        season: The season, whose end was begun.
        actor: Who wants it.

    Raises:
        RefusalError: It cannot go on before the organizers do something about it.
    """
    if season_state.is_finalized(session):
        return Ending(DONE)
    state = season_state.read_state(session, season_state.FINALIZING)
    if state is None:
        raise RefusalError("the season is not being decided")
    season = in_force(session, season)
    _check_playable(session, season)
    if state["field"] is None:
        settling = _settling(session, season)
        if settling is not None:
            return settling
        _check_complete(session, season)
        state = _choose_field(session, season, state, now)
    deciding = _deciding(session, season, state["field"])
    if deciding is not None:
        return deciding
    _decide(session, season, state["field"], actor, now)
    return Ending(DONE)


def _settling(session: Session, season: Season) -> Ending | None:
    """Return how far what was handed in is played; None if it is."""
    pending = _count(session, select(func.count()).where(Submission.state.in_(PENDING)))
    left = _count(session, select(func.count()).where(Match.state.in_((WAITING, PLAYING))))
    if not pending and not left and not ladders_want_matches(session, season):
        return None
    planned = _count(session, select(func.count()).where(Match.state != VOID))
    return Ending(SETTLING, planned - left, planned, pending, _why_it_stands(session))


def _check_playable(session: Session, season: Season) -> None:
    """Check that no match waits that cannot be played here.

    Raises:
        RefusalError: Some do; it names the submissions.
    """
    sandbox = sandbox_of(session, season)
    for track, edition in season.editions.items():
        obstacle = edition.obstacle(sandbox, model_of(season))
        if not obstacle:
            continue
        seats = select(MatchSeat.entrant).join(Match, Match.id == MatchSeat.match_id)
        waiting = seats.where(Match.edition_id == season.numbers[track], Match.state == WAITING)
        names = sorted(set(session.scalars(waiting)))
        if names:
            first = "take the end back (`wildscav season finalize --abort`) and "
            raise RefusalError(
                f"matches of {track} wait ({', '.join(names)}), and cannot be played: {obstacle}; bring that "
                f"back, or {first if season_state.is_decided(session) else ''}have all entries judged again "
                "(`wildscav season apply`)"
            )


def _check_complete(session: Session, season: Season) -> None:
    """Check that no entry would drop out of a board because its matches were not played.

    Raises:
        RefusalError: Some would; it names each of them.
    """
    missing = []
    for track, edition in season.editions.items():
        own = select(MatchSeat.entrant, func.count(Match.id.distinct())).join(
            Match, Match.id == MatchSeat.match_id
        )
        finished = own.where(
            Match.edition_id == season.numbers[track],
            ~Match.decides,
            Match.state == FINISHED,
            Match.superseded.is_(None),
        )
        played = {name: count for name, count in session.execute(finished.group_by(MatchSeat.entrant))}  # noqa: C416
        needed = edition.matches if edition.settings.mode == "suite" else 1
        missing += [
            f"{one.entrant} of {team.name} ({played.get(one.entrant, 0)} of {needed} matches of {track})"
            for one, team in boards.entered(session, track)
            if played.get(one.entrant, 0) < needed
        ]
    if missing:
        raise RefusalError(
            f"these would drop out of a board: {', '.join(missing)}; have their matches played (`wildscav "
            "season rerun`), or leave them out on purpose (`--leave-out N --reason …`)"
        )


def leave_out(session: Session, actor: str, numbers: Sequence[int], reason: str, now: datetime) -> None:
    """Leave submissions out of all boards from now on; the reason is shown to everyone.

    Raises:
        NotFoundError: There is no such submission.
        RefusalError: It does not take part, or the reason is not valid.
    """
    reason = checked_line(reason, "reason", LONGEST_REASON)
    left_out = dict(season_state.read_state(session, season_state.LEFT_OUT) or {})
    for number in numbers:
        submission = find_submission(session, number)
        if submission.state != states.ACTIVE:
            raise RefusalError(f"submission {number} is {submission.state}: it is on no board")
        left_out[str(number)] = reason
        log_act(session, actor, "leave out", f"submission {number}", now, reason)
    season_state.write_state(session, season_state.LEFT_OUT, left_out, now)


def _choose_field(session: Session, season: Season, state: dict[str, Any], now: datetime) -> dict[str, Any]:
    """Choose who plays the matches that decide each suite, and plan them."""
    boards.refresh(session, season, now)
    field: dict[str, list[int]] = {}
    for track, specs in season.final_matches.items():
        board = read_board(session, track, HIDDEN)
        ranked = [] if board is None else [row for row in board.rows if row.rank is not None]
        field[track] = [row.submission for row in ranked[: state["best"]] if row.submission is not None]
        for number in field[track]:
            submission = session.get_one(Submission, number)
            add_suite_matches(session, submission, track, specs, now, FINAL)
    chosen = {**state, "field": field | _fields_of(session, season, state["best"])}
    season_state.write_state(session, season_state.FINALIZING, chosen, now)
    return chosen


def _fields_of(session: Session, season: Season, best: int) -> dict[str, list[int]]:
    """Return who plays the final round of each ladder: whose intervals reach the first ``best`` places."""
    found = {}
    for track, settings in season.settings.tracks.items():
        board = read_board(session, track, HIDDEN) if settings.mode == "ladder" else None
        ranked = [] if board is None else [(row.submission, row.rank) for row in board.rows]
        field = [one for one, rank in ranked if one is not None and rank is not None and rank <= best]
        if len(field) > 1:
            found[track] = field
    return found


def _decided_by(session: Session, season: Season, field: Mapping[str, list[int]]) -> dict[str, list[int]]:
    """Return the field of each track that matches of the second secret decide."""
    finished = Match.decides, Match.state == FINISHED, are_in_force(session)
    played = set(session.scalars(select(Match.track).where(*finished).distinct()))
    modes = {track: settings.mode for track, settings in season.settings.tracks.items()}
    return {track: one for track, one in field.items() if modes[track] == "suite" or track in played}


def _deciding(session: Session, season: Season, field: dict[str, list[int]]) -> Ending | None:
    """Return how far the matches that decide the season are; None if they are played.

    Raises:
        RefusalError: Some were given up.
    """
    finals = Match.kind == FINAL, or_(false(), *_finals_of(session, season, field))
    own = select(func.count()).where(*finals)
    given_up = session.scalars(select(Match.group_id).where(*finals, Match.state == VOID).distinct()).all()
    if given_up:
        numbers = ", ".join(map(str, sorted(given_up)))
        raise RefusalError(
            f"final matches of {numbers} were given up after faults of the platform: find out why "
            "(`wildscav season status`), and have them played again (`wildscav season rerun`)"
        )
    rounds = select(func.count()).where(
        Match.decides, Match.kind == LADDER, Match.state != VOID, are_in_force(session)
    )
    planned = _count(session, own) + _count(session, rounds)
    played = sum(_count(session, one.where(Match.state == FINISHED)) for one in (own, rounds))
    is_over = played == planned and not ladders_want_matches(session, season)
    return None if is_over else Ending(DECIDING, played, planned, 0, _why_it_stands(session))


def _finals_of(
    session: Session, season: Season, field: Mapping[str, Collection[int]]
) -> Iterator[ColumnElement[bool]]:
    """Select the matches of those of the field that will be on the final board of each suite."""
    for track, chosen in field.items():
        on_board = [one.id for one, _ in boards.entered(session, track) if one.id in chosen]
        yield and_(Match.edition_id == season.numbers.get(track), Match.group_id.in_(on_board))


def _decide(session: Session, season: Season, field: dict[str, list[int]], actor: str, now: datetime) -> None:
    """Make the boards final, and open the secrets: all at once, or nothing."""
    field = _decided_by(session, season, field)
    conditions = {
        track: edition.final if track in field else edition.conditions
        for track, edition in season.editions.items()
    }
    final = boards.Final({track: frozenset(one) for track, one in field.items()}, conditions)
    boards.decide(session, season, final, now)
    secrets = {
        name: (season.folder / file).read_bytes().decode("ascii", "replace")
        for name, file in (("secret", SECRET_FILE), ("final_secret", FINAL_SECRET_FILE))
    }
    season_state.write_state(session, season_state.OPENED, secrets, now)
    log_act(session, actor, "decide", "season", now, "the boards are final, and the secrets are opened")


def _why_it_stands(session: Session) -> str:
    """Return why nothing is being played; an empty text if something is."""
    paused = season_state.read_state(session, season_state.PAUSED)
    if paused is not None:
        return f"the season is paused: {paused['reason']}"
    if holder_of(session, clock(session)) is None:
        return "nobody plays the matches: `wildscav season serve` starts what does"
    return ""


def _count(session: Session, counting: Any) -> int:
    return session.scalar(counting) or 0
