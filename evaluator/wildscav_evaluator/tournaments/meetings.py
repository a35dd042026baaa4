"""How often entrants meet each other in games."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Int = NDArray[np.int64]

MANY_CELLS = 4_000_000  # pairs of places that are listed one by one


def count_meetings(games: Int, entrants: int) -> Int:
    """Return in how many games (..., P) each pair plays, (n, n); the diagonal counts each entrant's games."""
    places = games.shape[-1]
    games = games.reshape(-1, places)
    if games.size * places <= MANY_CELLS:
        cells = (games[:, :, None] * entrants + games[:, None, :]).reshape(-1)
        return np.bincount(cells, minlength=entrants * entrants).reshape(entrants, entrants).astype(np.int64)
    # The product of the matrix of who plays in which game with itself. Its numbers are exact: far below
    # 2**24.
    played = np.zeros((len(games), entrants), np.float32)
    np.put_along_axis(played, games, 1.0, axis=1)
    return (played.T @ played).astype(np.int64)


def spread_of(meetings: Int, groups: Sequence[int]) -> int:
    """Return the most by which the meetings of two pairs of different groups differ; 0 without such pairs."""
    group = np.asarray(groups)
    met = meetings[group[:, None] != group[None, :]]
    return int(met.max() - met.min()) if met.size else 0
