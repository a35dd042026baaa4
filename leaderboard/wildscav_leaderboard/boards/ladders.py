"""The ladders of the season in the database: the places in their matches, in the order of their making.

Matches that were played under different conditions are not compared: after an upgrade of the engine, say, a
track's ladder begins anew. The final round is another ladder too, since its games come from another secret.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sqlalchemy import Select, delete, func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import MatchRow, metric_infos
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.tournaments.rated_matches import placing_metric
from wildscav_leaderboard.boards.matchmaking import REPEATS
from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.matches.models import FINISHED, LADDER, VOID, Match, MatchResult


class Played(NamedTuple):
    """The matches of a ladder that count."""

    matches: tuple[RatedMatch, ...] = ()  # in the order in which they were made
    faults: Mapping[str, int] = {}  # of each entrant: matches in which something went wrong in its seat


def played_on(session: Session, track: str, conditions: str | None) -> Played:
    """Return the matches of a ladder that were applied.

    Args:
        session: A session.
        track: The track.
        conditions: Digest of the conditions under which they were played; None for no ladder.
    """
    seats: dict[tuple[int, int], list[tuple[str, int]]] = {}
    faults: dict[str, int] = {}
    wanted = (
        select(LadderStep.match_id, Match.number, LadderStep.entrant, LadderStep.place, LadderStep.fault)
        .join(Match, Match.id == LadderStep.match_id)
        .where(LadderStep.track == track, LadderStep.conditions == conditions)
        .order_by(LadderStep.match_id, LadderStep.entrant)
    )
    for match, number, entrant, place, fault in session.execute(wanted):
        seats.setdefault((match, number), []).append((entrant, place))
        faults[entrant] = faults.get(entrant, 0) + fault
    return Played(tuple(placed_match(number, own) for (_, number), own in seats.items()), faults)


def apply_matches(session: Session, track: str) -> int:
    """Apply the matches that are over, in the order in which they were made; return how many are new.

    It stops at the first match that is not over, so that no later one is ever applied before it. Where a
    result took the place of an earlier one, all matches of the track are applied again.
    """
    if session.scalar(_superseded_steps(track).limit(1)) is not None:
        session.execute(delete(LadderStep).where(LadderStep.track == track))
    done = session.scalar(select(func.max(LadderStep.match_id)).where(LadderStep.track == track)) or 0
    over = _matches_over(session, track, done)
    for result in session.scalars(select(MatchResult).where(MatchResult.match_id.in_(over))):
        row = MatchRow.model_validate(result.row)
        places = places_of(track, [seat.metrics for seat in row.seats])
        session.add_all(
            LadderStep(
                match_id=result.match_id,
                entrant=str(seat.submission),
                track=track,
                conditions=result.conditions,
                place=place,
                fault=seat.fault is not None,
            )
            for seat, place in zip(row.seats, places, strict=True)
        )
    session.flush()
    return len(over)


def _matches_over(session: Session, track: str, after: int) -> list[int]:
    """Return the matches with a result that come before the first one that is not over."""
    wanted = select(Match.id, Match.state).where(
        Match.track == track, Match.kind == LADDER, Match.id > after, Match.superseded.is_(None)
    )
    found = []
    for number, state in session.execute(wanted.order_by(Match.id)):
        if state not in (FINISHED, VOID):
            break
        if state == FINISHED:
            found.append(number)
    return found


def places_of(track: str, seats: Sequence[dict[str, float]]) -> tuple[int, ...]:
    """Return the places in a match of a ladder, in which every entrant plays for itself.

    Args:
        track: The track.
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


def _superseded_steps(track: str) -> Select[int]:
    """Select the steps of a ladder whose results are superseded."""
    wanted = select(LadderStep.match_id).join(Match, Match.id == LadderStep.match_id)
    return wanted.where(LadderStep.track == track, Match.superseded.is_not(None))
