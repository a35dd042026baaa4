"""Straight lines between two places, seen from above."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel

Segment = NDArray[np.float64] | tuple[float, float, float, float]  # (4,) m, x and z of both ends


@kernel
def nearest_on(segment: Segment, x: float, z: float) -> tuple[float, float]:
    """Return x and z in m of the point nearest to (x, z) on a segment."""
    east, north = segment[2] - segment[0], segment[3] - segment[1]
    length = east * east + north * north
    share = ((x - segment[0]) * east + (z - segment[1]) * north) / length if length > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    return segment[0] + share * east, segment[1] + share * north
