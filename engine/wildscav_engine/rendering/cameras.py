"""Cameras: where they are, where they look, how far, and which thread makes the image of each.

A camera is a pinhole: square pixels, rays through pixel centres, row 0 at the top, column 0 at the left.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.parallel.turns import Turns

TAKEN_ALREADY = -1


class Cameras(NamedTuple):
    """N cameras with the same field of view and range."""

    eyes: NDArray[np.float64]  # (N, 3) m
    yaws: NDArray[np.float64]  # (N,) degrees
    pitches: NDArray[np.float64]  # (N,) degrees, positive looks down
    viewers: NDArray[np.int32]  # (N,) each hides the solids whose owner it is; -2 hides none
    half_width: float  # tangent of half the horizontal field of view
    far: float  # m along the ray, the greatest distance of a hit


@kernel
def are_finite(eyes: NDArray[np.float64], yaws: NDArray[np.float64], pitches: NDArray[np.float64]) -> bool:
    """Return whether all numbers of (N, 3), (N,) and (N,) are finite, and their sums as well."""
    for row in range(yaws.shape[0]):
        if not np.isfinite(eyes[row, 0] + eyes[row, 1] + eyes[row, 2] + yaws[row] + pitches[row]):
            return False
    return True


@inlined_kernel
def item_at(turns: Turns, turn: int) -> int:
    """Return the image of a turn, which the thread must then render, or TAKEN_ALREADY: see ``items_of``."""
    if turns.order.shape[0] == 0:
        return turn
    item = turns.order[turn]
    if turns.taken[item] != 0:
        return TAKEN_ALREADY
    turns.taken[item] = 1
    return int(item)
