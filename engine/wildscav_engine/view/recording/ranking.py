"""The order of the seats at each step of a match, and the numbers that standings show of them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.simulation.state import NOT_ELIMINATED
from wildscav_engine.simulation.track import Track
from wildscav_engine.view.recording.history import History

Keys = tuple[NDArray[np.generic], ...]  # (T + 1, A) each, the most significant first; less comes first


class Column(NamedTuple):
    """One number of every seat."""

    title: str
    values: NDArray[np.generic]  # (T + 1, A)
    write: Callable[[float], str] = lambda value: f"{value:.0f}"
    immediate: bool = True  # whether a change gives a new table at once, or only in the next second


def ranking_keys(track: Track, history: History) -> Keys:
    """Return what the seats are sorted by in each row of the history."""
    agents = history.agents
    keys: list[NDArray[np.generic]] = []
    if history.target is not None:
        keys.append(history.distance_to_target)
    if not track.respawns:
        out = agents.eliminated != NOT_ELIMINATED
        keys += [out, -np.where(out, agents.eliminated, 0)]
    if track.has_supplies:
        keys += [-history.supplies_of_team, history.teams + 0 * agents.supplies, -agents.supplies]
    # In a track without anything to be ordered by during the match, seats stand in their order.
    keys.append(np.broadcast_to(np.arange(agents.health.shape[1]), agents.health.shape))
    return tuple(keys)


def order_at(keys: Keys, row: int) -> list[int]:
    """Return the seats in their order, best first."""
    order: list[int] = np.lexsort([key[row] for key in reversed(keys)]).tolist()
    return order


def first_of(order: list[int], count: int, followed: int | None) -> list[int]:
    """Return the first seats of an order, the last of which gives way to the followed one if it is behind."""
    first = order[:count]
    if followed is not None and followed not in first:
        first[-1] = followed
    return first
