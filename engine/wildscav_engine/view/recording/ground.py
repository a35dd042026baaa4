"""The height of points that lie on the ground."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World


@kernel
def lay_on_ground(world: World, lift: float, points: NDArray[np.float64]) -> None:
    """Set the height of (N, 3) points to ``lift`` metres above the ground."""
    for point in range(points.shape[0]):
        points[point, 1] = ground_at(world, points[point, 0], points[point, 2]).height + lift
