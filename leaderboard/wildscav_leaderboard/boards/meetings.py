"""Who met whom on a ladder, and how it went: read from the steps of the ladder alone."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from sqlalchemy import ColumnElement, func, or_, select
from sqlalchemy.orm import Session

from wildscav_evaluator.ratings.head_to_head import PairRecord
from wildscav_evaluator.ratings.head_to_head import head_to_head as records_of
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_leaderboard.boards.ladders import version_of
from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.database.connection import KEPT


class Ladder(NamedTuple):
    """A ladder, or its first matches."""

    track: str
    conditions: str  # their digest
    applied: int | None = None  # how many matches count, from the first one on; None for all


def head_to_head(
    session: Session, track: str, conditions: str, entrants: Collection[str], applied: int | None = None
) -> dict[tuple[str, str], PairRecord]:
    """Return the record of every two entrants that met on a ladder, in both orders.

    Args:
        conditions: Digest of the conditions of the ladder.
        applied: How many matches of the ladder count, from its first one on; None for all.
    """
    wanted = (
        select(LadderStep.match_id, LadderStep.entrant, LadderStep.place)
        .where(_counts(session, track, conditions, applied), LadderStep.entrant.in_(list(entrants)))
        .order_by(LadderStep.match_id)
    )
    return records_of(_matches((match, name, place) for match, name, place in session.execute(wanted)))


def records_on(session: Session, ladders: Sequence[Ladder], entrant: str) -> dict[str, dict[str, PairRecord]]:
    """Return an entrant's record on some ladders, at least one: by track, and by whom it met.

    Args:
        ladders: The ladders, each of another track.
    """
    # All of this is decided by its own steps, which an index finds.
    own = select(LadderStep.match_id).where(
        LadderStep.entrant == entrant, or_(*(_counts(session, *ladder) for ladder in ladders))
    )
    wanted = select(LadderStep.track, LadderStep.match_id, LadderStep.entrant, LadderStep.place)
    steps: dict[str, list[tuple[int, str, int]]] = {ladder.track: [] for ladder in ladders}
    met = wanted.where(LadderStep.match_id.in_(own)).order_by(LadderStep.match_id)
    for track, match, name, place in session.execute(met):
        steps[track].append((match, name, place))
    return {
        track: {other: record for (one, other), record in records_of(_matches(own)).items() if one == entrant}
        for track, own in steps.items()
    }


def _counts(session: Session, track: str, conditions: str, applied: int | None) -> ColumnElement[bool]:
    """Return whether a step is one of a ladder, or of its first matches."""
    chosen = (LadderStep.track == track) & (LadderStep.conditions == conditions)
    if applied is None:
        return chosen
    return chosen & (LadderStep.match_id <= _last_match(session, track, conditions, applied))


def _last_match(session: Session, track: str, conditions: str, applied: int) -> int:
    """Return the last one of the first matches of a ladder. It is kept until the ladder begins anew."""
    begun = version_of(session, track)["begun"]
    kept, key = session.info.get(KEPT, {}), (LadderStep, track, conditions, applied, begun)
    last: int | None = kept.get(key)
    if last is None:
        steps = select(LadderStep.match_id).where(
            LadderStep.track == track, LadderStep.conditions == conditions
        )
        first = steps.distinct().order_by(LadderStep.match_id).limit(applied).subquery()
        last = session.scalar(select(func.max(first.c.match_id))) or 0
        for old in [one for one in list(kept) if isinstance(one, tuple) and one[:3] == key[:3]]:
            kept.pop(old, None)
        kept[key] = last
    return last


def _matches(steps: Iterable[tuple[int, str, int]]) -> Iterator[RatedMatch]:
    """Yield the matches of some steps in which at least two met."""
    found: dict[int, list[tuple[str, int]]] = {}
    for match, entrant, place in steps:
        found.setdefault(match, []).append((entrant, place))
    for match, seats in found.items():
        if len(seats) < 2:
            continue  # nobody else of those who were asked about played in it
        yield RatedMatch(match, tuple((name,) for name, _ in seats), tuple(place for _, place in seats))
