"""Bringing editions into force, and what that costs: an edit of the settings shows its effect first.

The conductor brings the first edition of a track into force by itself, and another one as long as no match
was made. From then on a change waits until the organizers apply it; until then the old edition goes on, where
it can still be played.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from hashlib import blake2b

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_evaluator.output.results import ModelTerms
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import Board, LadderStep
from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.database.connection import clock
from wildscav_leaderboard.matches.models import FINISHED, LADDER, VOID, WAITING, Match, MatchResult
from wildscav_leaderboard.matches.service import NOT_IN_FORCE
from wildscav_leaderboard.seasons.editions import Edition, changes_between, digest_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import (
    edition_numbers,
    edition_of,
    enter_edition,
    in_force,
    model_of,
    sandbox_of,
)
from wildscav_leaderboard.seasons.models import EditionRow
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.state import NODES, is_decided, log_act, read_state
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import taking_part
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.visibility import HIDDEN

RECENT = 100  # matches from which the time of a match is estimated


@dataclass(frozen=True)
class EditionChange:
    """How the rules of a track, as they are written now, differ from the edition in force."""

    track: str
    edition: Edition | None  # that would come into force; None where the track is removed
    differences: Sequence[str]
    entries: int  # submissions that have to be judged again
    matches: int  # that they play
    waiting: int  # matches of the edition in force that would be given up
    seconds: float | None  # how long it takes, about; None if no match was played yet
    obstacle: str  # why the edition in force cannot be played any more; empty if it can

    @property
    def text(self) -> str:
        """The change and its effect in one line."""
        if self.edition is None:
            said = f"{self.track} is removed: its boards stay as they are"
        else:
            time = "" if self.seconds is None else f": about {_time(self.seconds)}"
            these = "this 1 entry has" if self.entries == 1 else f"these {self.entries:,} entries have"
            said = f"{self.track}: {'; '.join(self.differences)}: {these} to be judged again{time}"
        if self.waiting:
            given_up = "wait until then" if self.obstacle else "are given up"
            said += f"; {counted(self.waiting, 'match')} of the edition in force {given_up}"
        return f"{said} ({self.obstacle})" if self.obstacle and self.waiting else said


def begin_editions(session: Session, season: Season, now: datetime) -> list[EditionChange]:
    """Bring into force what needs no decision; return the changes that wait for one.

    Args:
        session: A writing session.
    """
    from wildscav_leaderboard.conductor.plans import plan_suites

    written, numbers = season.as_written or season, edition_numbers(session)
    if is_decided(session):
        return []
    for track in written.settings.tracks:
        if track not in numbers and _adopt(session, written, track, now):
            continue
        matches = select(Match.id).filter_by(edition_id=numbers.get(track)).limit(1)
        if track not in numbers or session.scalar(matches) is None:
            _enter(session, written, track, edition_of(written, track, sandbox_of(session, written)), now)
    _give_up_others(session, now)
    in_use = in_force(session, written)
    for submission in session.scalars(select(Submission).filter_by(state=ACTIVE)).all():
        plan_suites(session, in_use, submission, now)  # what was not planned while its edition had to wait
    return edition_changes(session, written)


def _adopt(session: Session, season: Season, track: str, now: datetime) -> bool:
    """Let what was played before there were editions go on as one, and bring that into force.

    Returns:
        Whether there was anything.
    """
    board = read_board(session, track, HIDDEN)
    if board is None or session.scalar(select(EditionRow.id).filter_by(track=track).limit(1)) is not None:
        return False
    known = board.conditions.model_fields_set
    before = blake2b(
        board.conditions.model_dump_json(exclude_unset=True).encode(), digest_size=16
    ).hexdigest()
    edition = edition_of(season, track, sandbox_of(session, season))
    conditions = edition.conditions.model_copy(update={one: getattr(board.conditions, one) for one in known})
    number = enter_edition(session, track, edition.model_copy(update={"conditions": conditions}), now)
    own = select(MatchResult.match_id).join(Match, Match.id == MatchResult.match_id)
    own = own.where(Match.track == track, MatchResult.conditions == before)
    mine = Match.id.in_(own) | (Match.state != FINISHED)
    session.execute(update(Match).where(Match.track == track, mine).values(edition_id=number))
    for table in (LadderStep, MatchResult):
        session.execute(
            update(table)
            .where(table.match_id.in_(select(Match.id).filter_by(edition_id=number)))
            .values(conditions=digest_of(conditions))
        )
    for row in session.scalars(select(Board).filter_by(track=track)):  # a frozen one stays as it is
        row.document = {**row.document, "conditions": conditions.model_dump(mode="json")}
    return True


def edition_changes(session: Session, season: Season) -> list[EditionChange]:
    """Return how the rules as they are written differ from the editions in force, and what that costs."""
    written = season.as_written or season
    if is_decided(session):
        return []
    sandbox, in_use = sandbox_of(session, written), in_force(session, written)
    found = []
    for track, old in in_use.editions.items():
        number = in_use.numbers[track]
        new = edition_of(written, track, sandbox) if track in written.settings.tracks else None
        differences = [] if new is None else changes_between(track, old, new)
        if new is not None and (new.conditions.commitment, new.final_commitment) != (
            old.conditions.commitment,
            old.final_commitment,
        ):
            raise RefusalError(
                f"the secrets are not those of the edition of {track} in force, whose commitments were "
                "published: put the files back"
            )
        if new is not None and not differences:
            continue
        entries = 0 if new is None else len(taking_part(session, track))
        each = 0 if new is None else new.matches if new.settings.mode == "suite" else new.settings.matches
        matches = entries * each // (new.conditions.seats if new is not None else 1)
        found.append(
            EditionChange(
                track=track,
                edition=new,
                differences=differences,
                entries=entries,
                matches=matches,
                waiting=_count_waiting(session, number),
                seconds=_time_of(session, track, matches),
                obstacle=old.obstacle(sandbox, model_of(season)),
            )
        )
    return found


def why_to_restart(session: Session, season: Season) -> str | None:
    """Return what only a conductor that is started now could play; None if nothing.

    The one that runs keeps the sandbox and the model that the settings named when it was started.
    """
    nodes = read_state(session, NODES) or {}
    if "model" not in nodes or holder_of(session, clock(session)) is None:
        return None
    model = None if nodes["model"] is None else ModelTerms.model_validate(nodes["model"])
    known, wanted = (nodes["sandbox"], model), (sandbox_of(session, season), model_of(season))
    editions = in_force(session, season).editions.items()
    tracks = [track for track, one in editions if one.obstacle(*known) and not one.obstacle(*wanted)]
    said = (
        "wait until you start `wildscav season serve` again, with the sandbox and the model of the settings"
    )
    return f"matches of {', '.join(tracks)} {said}" if tracks else None


def apply_editions(session: Session, season: Season, actor: str, now: datetime) -> list[EditionChange]:
    """Bring the rules as they are written into force, and have everything judged again that they concern.

    The results of the editions before stay as they are, on boards of their own.

    Raises:
        RefusalError: There is nothing to apply, or the season is being decided.
    """
    if is_decided(session):
        raise RefusalError("the season is decided, or its final matches are played: no rule may change now")
    written = season.as_written or season
    changes = edition_changes(session, written)
    if not changes:
        raise RefusalError("the settings are those that are in force: there is nothing to apply")
    for change in changes:
        number = _enter(session, written, change.track, change.edition, now)
        subject = f"track {change.track}" if number is None else f"edition {number} of {change.track}"
        log_act(session, actor, "apply", subject, now, change.text)
    return changes


def _enter(
    session: Session, season: Season, track: str, edition: Edition | None, now: datetime
) -> int | None:
    """Bring an edition into force, and plan its matches."""
    from wildscav_leaderboard.conductor.plans import plan_suites  # which loads SciPy, for ladders

    number = enter_edition(session, track, edition, now)
    _give_up_others(session, now)
    if number is not None:
        for submission, _ in taking_part(session, track):
            plan_suites(session, season, submission, now)
    return number


def _give_up_others(session: Session, now: datetime) -> None:
    """Give up the matches that wait under editions not in force; those in force again wait again.

    New matches of a ladder take the place of those it gave up, since matches are applied in their order.
    """
    in_use = edition_numbers(session).values()
    others = Match.edition_id.is_(None) | Match.edition_id.not_in(in_use)
    given_up = update(Match).where(Match.state == WAITING, others)
    session.execute(given_up.values(state=VOID, since=now, detail=NOT_IN_FORCE))
    is_back = Match.edition_id.in_(in_use), Match.state == VOID, Match.detail == NOT_IN_FORCE
    again = update(Match).where(*is_back, (Match.kind != LADDER) | (Match.judging > 1))
    session.execute(again.values(state=WAITING, since=now, detail=""))


def _count_waiting(session: Session, edition: int) -> int:
    wanted = select(func.count()).select_from(Match).filter_by(edition_id=edition, state=WAITING)
    return session.scalar(wanted) or 0


def _time_of(session: Session, track: str, matches: int) -> float | None:
    """Return how long matches take, s, as long as the last ones did; None if there are none."""
    wanted = (
        select(MatchResult.timing["wall"])
        .join(Match, Match.id == MatchResult.match_id)
        .where(Match.track == track)
        .order_by(Match.id.desc())
        .limit(RECENT)
    )
    walls = [float(wall) for wall in session.scalars(wanted)]
    at_once = int((read_state(session, NODES) or {}).get("at_once") or 1)
    return matches * sum(walls) / len(walls) / at_once if walls else None


def _time(seconds: float) -> str:
    """Return a rough time in words."""
    if seconds < 90.0:
        return counted(max(1, round(seconds)), "second")
    if seconds < 90.0 * 60.0:
        return counted(round(seconds / 60.0), "minute")
    return counted(round(seconds / 3600.0), "hour")
