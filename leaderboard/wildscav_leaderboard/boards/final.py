"""What decides a season: the field of each suite, and the conditions of the final boards."""

from collections.abc import Mapping
from datetime import datetime
from typing import NamedTuple

from sqlalchemy.orm import Session

from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.editions import Conditions


class Final(NamedTuple):
    """What the final boards of a season are computed from. It does not change with a newer Wildscav."""

    field: Mapping[str, frozenset[int]]  # the submissions that played the final matches of each suite
    conditions: Mapping[str, Conditions]  # of each track


def read_final(session: Session) -> Final | None:
    """Return what the final boards are computed from; None before the season is decided."""
    state = season_state.read_state(session, season_state.FINALIZED)
    if state is None:
        return None
    return Final(
        {track: frozenset(numbers) for track, numbers in state["field"].items()},
        {track: Conditions.model_validate(one) for track, one in state["conditions"].items()},
    )


def write_final(session: Session, final: Final, now: datetime) -> None:
    """Decide the season: from now on its boards are final."""
    value = {
        "at": now.isoformat(),
        "field": {track: sorted(numbers) for track, numbers in final.field.items()},
        "conditions": {track: one.model_dump(mode="json") for track, one in final.conditions.items()},
    }
    season_state.write_state(session, season_state.FINALIZED, value, now)
