"""What can be done with matches: plan them, take the next ones, store their results."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from datetime import datetime
from itertools import chain, zip_longest
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, and_, func, or_, select, update
from sqlalchemy.orm import Session, defer

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.results import MatchRow, MatchTiming, MetricInfo
from wildscav_evaluator.seats import submission_seats
from wildscav_leaderboard.matches.models import (
    FINISHED,
    LADDER,
    PLAYING,
    SEASON_ROUND,
    SUITE,
    VOID,
    WAITING,
    Match,
    MatchResult,
    MatchSeat,
)
from wildscav_leaderboard.seasons.editions import digest_of
from wildscav_leaderboard.seasons.in_force import edition_by_number, edition_numbers
from wildscav_leaderboard.seasons.refusals import NotFoundError
from wildscav_leaderboard.submissions.models import Submission

MAX_LISTED = 100  # in one list
WITHDRAWN = "withdrawn: "  # begins why a match is void that is planned again if its submission plays again
NOT_IN_FORCE = "its edition is no longer in force"  # why a match is void that waits again if it is


class Entrant(NamedTuple):
    """Who plays in a seat."""

    name: str  # the submission's entrant, or robot:NAME
    submission: int | None  # None for a robot


class Seat(NamedTuple):
    """A seat of a match that has an entrant."""

    seat: int
    entrant: str
    submission_id: int | None  # None for a robot


class PlayedRecord(NamedTuple):
    """What is stored of a match's record."""

    digest: str  # BLAKE2b, 32 hexadecimal digits
    size: int  # bytes


def add_suite_matches(
    session: Session,
    submission: Submission,
    track: str,
    specs: Sequence[MatchSpec],
    now: datetime,
    kind: str = SUITE,
) -> int:
    """Plan the matches of a suite that a submission has not got yet; return how many are new.

    Args:
        session: A writing session.
        kind: ``SUITE``, or ``FINAL`` for the matches that decide the season.
    """
    edition = edition_numbers(session).get(track)
    wanted = select(Match.number).filter_by(
        kind=kind, track=track, group_id=submission.id, edition_id=edition
    )
    withdrawn = Match.id.in_(wanted.with_only_columns(Match.id)), Match.state == VOID
    session.execute(
        update(Match)
        .where(*withdrawn, Match.detail.startswith(WITHDRAWN))
        .values(state=WAITING, since=now, detail="")
    )
    known = set(session.scalars(wanted))
    entrant = Entrant(submission.entrant, submission.id)
    new = [number for number in range(len(specs)) if number not in known]
    for number in new:
        spec = specs[number].model_dump(mode="json")
        # Everyone's first match comes before anyone's second one, so that boards fill evenly.
        match = _match(kind, track, edition, number, submission.id, spec, now, priority=number)
        add_match(session, match, dict.fromkeys(submission_seats(specs[number].seats), entrant))
    return len(new)


def add_ladder_match(
    session: Session,
    track: str,
    number: int,
    spec: MatchSpec,
    entrants: Mapping[int, Entrant],
    now: datetime,
    group: int = SEASON_ROUND,
) -> Match:
    """Plan a match of a ladder.

    Args:
        session: A writing session.
        number: Of the ladder's matches, one more than the last.
        entrants: Who plays in the seats that have an entrant.
        group: Of the ladder: that of the season, or the final round.
    """
    edition = edition_numbers(session).get(track)
    match = _match(LADDER, track, edition, number, group, spec.model_dump(mode="json"), now)
    return add_match(session, match, entrants)


def _match(
    kind: str,
    track: str,
    edition: int | None,
    number: int,
    group: int,
    spec: dict[str, Any],
    now: datetime,
    priority: int = 0,
    judging: int = 1,
) -> Match:
    return Match(
        kind=kind,
        track=track,
        edition_id=edition,
        number=number,
        group_id=group,
        spec=spec,
        created=now,
        since=now,
        priority=priority,
        judging=judging,
    )


def add_match(session: Session, match: Match, entrants: Mapping[int, Entrant]) -> Match:
    """Add a match with its seats."""
    session.add(match)
    session.flush()
    session.add_all(
        MatchSeat(match_id=match.id, seat=seat, submission_id=one.submission, entrant=one.name)
        for seat, one in entrants.items()
    )
    session.flush()
    return match


def find_match(session: Session, number: int) -> Match:
    """Return a match.

    Raises:
        NotFoundError: There is none of this number.
    """
    found = session.get(Match, number)
    if found is None:
        raise NotFoundError(f"there is no match {number}")
    return found


def list_matches(
    session: Session,
    *,
    submission: int | None = None,
    team: int | None = None,
    track: str | None = None,
    state: str | None = None,
    before: int | None = None,
    limit: int = MAX_LISTED,
) -> list[Match]:
    """Return matches, the newest first: of a submission or a team, on a track, in a state."""
    wanted = select(Match).order_by(Match.id.desc()).limit(limit).options(defer(Match.spec))  # it is large
    own = select(MatchSeat.match_id).join(Submission, Submission.id == MatchSeat.submission_id)
    for column, number in ((Submission.id, submission), (Submission.team_id, team)):
        if number is not None:
            wanted = wanted.where(Match.id.in_(own.where(column == number)))
    for name, value in ((Match.track, track), (Match.state, state)):
        if value is not None:
            # Most matches are finished, and many on each track: the newest are found without an index.
            most = func.coalesce(name, "")
            wanted = wanted.where((name if value in (WAITING, PLAYING, VOID) else most) == value)
    if before is not None:
        wanted = wanted.where(Match.id < before)
    return list(session.scalars(wanted))


def results_of(session: Session, matches: list[Match]) -> dict[int, MatchResult]:
    """Return the results of some matches, by match."""
    wanted = select(MatchResult).where(MatchResult.match_id.in_([match.id for match in matches]))
    return {result.match_id: result for result in session.scalars(wanted)}


def seats_of(session: Session, matches: Sequence[int]) -> dict[int, list[Seat]]:
    """Return the seats of some matches that have an entrant, by match."""
    found: dict[int, list[Seat]] = defaultdict(list)
    columns = (MatchSeat.match_id, MatchSeat.seat, MatchSeat.entrant, MatchSeat.submission_id)
    wanted = select(*columns).where(MatchSeat.match_id.in_(matches))
    wanted = wanted.order_by(MatchSeat.match_id, MatchSeat.seat)
    for match, seat, entrant, submission in session.execute(wanted):
        found[match].append(Seat(seat, entrant, submission))
    return found


def are_in_force(session: Session) -> ColumnElement[bool]:
    """Select the matches of the editions in force; those of a track that has none are of no edition."""
    numbers = edition_numbers(session)
    of_none = and_(Match.edition_id.is_(None), Match.track.not_in(numbers))
    return or_(Match.edition_id.in_(numbers.values()), of_none)


def next_matches(session: Session, editions: Mapping[str, int | None], count: int) -> list[Match]:
    """Return the matches that are played next: of each track in turn, by priority and then by age.

    Args:
        editions: The tracks that are played, and the edition of each: no other one's matches are played.
        count: How many, at most.
    """
    waiting = [
        session.scalars(
            select(Match)
            .filter_by(state=WAITING, track=track, edition_id=edition)
            .order_by(Match.priority, Match.id)
            .limit(count)
        ).all()
        for track, edition in editions.items()
    ]
    return [match for match in chain(*zip_longest(*waiting)) if match is not None][:count]


def void(match: Match, now: datetime, why: str) -> None:
    """Give a match up: it has no result, and counts for nobody."""
    match.state, match.since, match.deadline, match.detail = VOID, now, None, why


def withdraw(session: Session, submission: Submission, now: datetime, track: str | None = None) -> None:
    """Give up the matches of a submission that are not played yet, on a track or on all: it left."""
    own = select(MatchSeat.match_id).filter_by(submission_id=submission.id)
    on_track = [] if track is None else [Match.track == track]
    session.execute(
        update(Match)
        .where(Match.id.in_(own), Match.state == WAITING, *on_track)
        .values(state=VOID, since=now, detail=f"{WITHDRAWN}submission {submission.id} no longer takes part")
    )


def takes_part(session: Session, match: Match) -> bool:
    """Return whether all submissions of a match take part on its track."""
    seated = select(Submission).join(MatchSeat, MatchSeat.submission_id == Submission.id)
    found = session.scalars(seated.where(MatchSeat.match_id == match.id))
    return all(match.track in one.playing for one in found)


def last_arrival(session: Session) -> datetime | None:
    """Return when the last result arrived; None if there is none."""
    return session.scalar(select(func.max(MatchResult.at)))


def deliver(
    session: Session,
    match: Match,
    attempt: int | None,
    row: MatchRow,
    timing: MatchTiming,
    record: PlayedRecord,
    metric: MetricInfo,
    now: datetime,
) -> bool:
    """Store the result of a match, unless it has one: the first to arrive stays.

    Args:
        session: A writing session.
        row: How it went, for all entrants.
        record: Its record, which is in the season's files.

    Returns:
        Whether it was stored.
    """
    if session.get(MatchResult, match.id) is not None or match.state == VOID:
        return False
    score = None if row.metrics is None else row.metrics[metric.name]
    # A clock may be set back, but results stay in the order of their arrival.
    now = max(now, last_arrival(session) or now)
    session.add(
        MatchResult(
            match_id=match.id,
            attempt_id=attempt,
            at=now,
            row=row.model_dump(mode="json"),
            timing=timing.model_dump(mode="json"),
            conditions=_conditions_of(session, match),
            record=record.digest,
            record_size=record.size,
            fault=row.fault,
            score=None if match.kind == LADDER else score,
        )
    )
    match.state, match.since, match.deadline = FINISHED, now, None
    if match.judging > 1:
        _supersede(session, match, now)
    session.flush()
    return True


def _conditions_of(session: Session, match: Match) -> str:
    """Return the digest of the conditions under which a match is played: those of its edition."""
    if match.edition_id is None:
        return ""
    edition = edition_by_number(session, match.edition_id)
    return digest_of(edition.final if match.decides else edition.conditions)


def _same_match(match: Match) -> ColumnElement[bool]:
    """Select all judgings of a match."""
    return and_(
        Match.kind == match.kind,
        Match.track == match.track,
        Match.number == match.number,
        Match.group_id == match.group_id,
        Match.edition_id == match.edition_id,
    )


def _supersede(session: Session, match: Match, now: datetime) -> None:
    """Let a result take the place of the earlier ones of the same match, which are kept."""
    earlier = (Match.judging < match.judging, Match.superseded.is_(None))
    session.execute(update(Match).where(_same_match(match), *earlier).values(superseded=now))


def judge_again(session: Session, match: Match, now: datetime) -> Match | None:
    """Plan to play a match again that is over; return None if that is planned already.

    Its result counts until the new one arrives.
    """
    judged = session.scalars(select(Match).where(_same_match(match)).order_by(Match.judging.desc())).all()
    if judged[0].state in (WAITING, PLAYING):
        return None
    same = (match.kind, match.track, match.edition_id, match.number, match.group_id, match.spec)
    again = _match(*same, now, match.priority, judged[0].judging + 1)
    seats = seats_of(session, [match.id])[match.id]
    return add_match(session, again, {one.seat: Entrant(one.entrant, one.submission_id) for one in seats})


def mark_playing(match: Match, now: datetime, deadline: datetime) -> None:
    """Mark a match as being played."""
    match.state, match.since, match.deadline = PLAYING, now, deadline


def mark_waiting(session: Session, match: Match, now: datetime) -> None:
    """Let a match wait to be played again, or give it up if its edition is no longer in force."""
    if edition_numbers(session).get(match.track) != match.edition_id:
        void(match, now, NOT_IN_FORCE)
        return
    match.state, match.since, match.deadline = WAITING, now, None
