"""The ladders of the season in the database: the places in their matches, in the order of their making.

Matches that were played under different conditions are not compared: after an upgrade of the engine, say, a
track's ladder begins anew. The final round is another ladder too, since its games come from another secret.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile
from typing import TYPE_CHECKING, Any, NamedTuple

from sqlalchemy import delete, func, insert, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import MatchRow, metric_infos
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.tournaments.rated_matches import placing_metric
from wildscav_leaderboard.boards.matchmaking import REPEATS
from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.database.connection import COMMITTED, KEPT, clock
from wildscav_leaderboard.matches.models import FINISHED, LADDER, VOID, Match, MatchResult
from wildscav_leaderboard.seasons.state import read_state, write_state

if TYPE_CHECKING:
    from wildscav_evaluator.ratings.fit import Fit

AT_ONCE = 1000  # matches that are applied in one transaction, at most, unless a ladder begins anew


@dataclass(frozen=True)
class Played:
    """The matches of a ladder that count."""

    matches: tuple[RatedMatch, ...] = ()  # in the order in which they were made
    faults: Mapping[str, int] = field(default_factory=dict)  # of each entrant: matches with one in its seat

    @cached_property
    def fit(self) -> "Fit":
        """The ratings that follow from the matches, of which there is at least one."""
        from wildscav_evaluator.ratings.fit import fit

        return fit(self.matches)


class _Kept(NamedTuple):
    """What sessions that read know of a ladder."""

    version: dict[str, Any]
    last: int  # the last match that was read
    played: Played


def version_of(session: Session, track: str) -> dict[str, Any]:
    """Return what changes whenever matches of a track are applied: how often all were, and the last one."""
    return read_state(session, f"ladder:{track}") or {"begun": 0, "last": 0}


def played_on(session: Session, track: str, conditions: str | None) -> Played:
    """Return the matches of a ladder that were applied.

    Sessions that read keep them, with their fit, and read only new ones the next time. One that writes uses
    what was kept, unless a match has been applied since.

    Args:
        conditions: Digest of the conditions under which they were played; None for no ladder.
    """
    key, version = (Played, track, conditions), version_of(session, track)
    kept: dict[Hashable, Any] = session.info.get(KEPT) or session.info.get(COMMITTED) or {}
    known: _Kept = kept.get(key) or _Kept({}, 0, Played())
    if known.version == version:
        return known.played
    if known.version.get("begun") != version["begun"]:
        known = _Kept(version, 0, Played())
    known = _Kept(version, *_read_on(session, track, conditions, known))
    if KEPT in session.info:  # what a session has written may be undone
        session.info[KEPT][key] = known
    return known.played


def _read_on(session: Session, track: str, conditions: str | None, known: _Kept) -> tuple[int, Played]:
    """Return the last match of a ladder, and all that count: those that are known, and later ones."""
    seats: dict[tuple[int, int], list[tuple[str, int]]] = {}
    faults = dict(known.played.faults)
    wanted = (
        select(LadderStep.match_id, Match.number, LadderStep.entrant, LadderStep.place, LadderStep.fault)
        .join(Match, Match.id == LadderStep.match_id)
        .where(
            LadderStep.track == track, LadderStep.conditions == conditions, LadderStep.match_id > known.last
        )
        .order_by(LadderStep.match_id, LadderStep.entrant)
    )
    for match, number, entrant, place, fault in session.execute(wanted):
        seats.setdefault((match, number), []).append((entrant, place))
        faults[entrant] = faults.get(entrant, 0) + fault
    if not seats:
        return known.last, known.played
    new = [placed_match(number, own) for (_, number), own in seats.items()]
    return max(seats)[0], Played((*known.played.matches, *new), faults)


def apply_matches(session: Session, track: str) -> int:
    """Apply the next matches that are over, in the order in which they were made; return how many are new.

    It stops at the first match that is not over, so that no later one is ever applied before it. Where a
    result took the place of an earlier one, all matches of the track are applied again, at once, so that no
    reader sees a part of them.
    """
    begun = version_of(session, track)["begun"]
    if begins_anew := _has_superseded(session, track):
        session.execute(delete(LadderStep).where(LadderStep.track == track))
        begun += 1
    last = session.scalar(select(func.max(LadderStep.match_id)).where(LadderStep.track == track)) or 0
    count = 0
    while over := _matches_over(session, track, last):
        _apply(session, track, over)
        last, count = over[-1], count + len(over)
        if not begins_anew:
            break
    version = {"begun": begun, "last": last}
    if version != version_of(session, track):
        write_state(session, f"ladder:{track}", version, clock(session))
        session.flush()
    return count


def _apply(session: Session, track: str, over: Sequence[int]) -> None:
    """Add the places in matches to the ladder."""
    steps = []
    for result in session.scalars(select(MatchResult).where(MatchResult.match_id.in_(over))):
        row = MatchRow.model_validate(result.row)
        places = places_of(track, [seat.metrics for seat in row.seats])
        steps += [
            {
                "match_id": result.match_id,
                "entrant": str(seat.submission),
                "track": track,
                "conditions": result.conditions,
                "place": place,
                "fault": seat.fault is not None,
            }
            for seat, place in zip(row.seats, places, strict=True)
        ]
    if steps:
        session.execute(insert(LadderStep), steps)


def _matches_over(session: Session, track: str, after: int) -> list[int]:
    """Return the next matches with a result that come before the first one that is not over."""
    wanted = (
        select(Match.id, Match.state)
        .where(Match.track == track, Match.kind == LADDER, Match.state != VOID)
        .where(Match.id > after, Match.superseded.is_(None))
        .order_by(Match.id)
        .limit(AT_ONCE)
    )
    found = session.execute(wanted)
    return [match for match, _ in takewhile(lambda one: one[1] == FINISHED, found)]


def places_of(track: str, seats: Sequence[dict[str, float]]) -> tuple[int, ...]:
    """Return the places in a match of a ladder, in which every entrant plays for itself.

    Args:
        seats: The metrics of each seat.
    """
    metric = placing_metric(metric_infos(track))
    sign = 1.0 if metric.lower_is_better else -1.0
    values = [sign * metrics[metric.name] for metrics in seats]
    return tuple(1 + sum(other < value for other in values) for value in values)


def placed_match(number: int, seats: Sequence[tuple[str, int]]) -> RatedMatch:
    """Return a match of a ladder as it is rated.

    Args:
        number: Of the match on its ladder.
        seats: Every entrant and its place.
    """
    ordered = sorted(seats)
    teams = tuple((entrant,) for entrant, _ in ordered)
    return RatedMatch(number // REPEATS, teams, tuple(place for _, place in ordered))


def _has_superseded(session: Session, track: str) -> bool:
    """Return whether a result was applied whose place another one has taken."""
    applied = select(LadderStep).where(LadderStep.match_id == Match.id).exists()
    wanted = select(Match.id).where(Match.track == track, Match.superseded.is_not(None), applied)
    return session.scalar(wanted.limit(1)) is not None
