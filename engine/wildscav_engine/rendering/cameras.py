"""Where cameras stand and which way the rays of their pixels go.

A pinhole: square pixels, rays through pixel centres, row 0 at the top, column 0 at the left.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel


class Cameras(NamedTuple):
    """N cameras of one lens."""

    eyes: NDArray[np.float64]  # (N, 3) m
    yaws: NDArray[np.float64]  # (N,) degrees
    pitches: NDArray[np.float64]  # (N,) degrees, positive looks down
    viewers: NDArray[np.int32]  # (N,) who do not see what they own; -2 for nobody
    half_width: float  # tangent of half the horizontal field of view
    far: float  # m along the ray, beyond which nothing is met


@kernel
def are_finite(eyes: NDArray[np.float64], yaws: NDArray[np.float64], pitches: NDArray[np.float64]) -> bool:
    """Return whether all of (N, 3), (N,) and (N,) numbers are finite, and their sums."""
    for row in range(yaws.shape[0]):
        if not np.isfinite(eyes[row, 0] + eyes[row, 1] + eyes[row, 2] + yaws[row] + pitches[row]):
            return False
    return True
