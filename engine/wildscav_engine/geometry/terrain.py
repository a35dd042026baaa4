"""The height field: heights, slopes and water at a point."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World, cell_of
from wildscav_engine.specs.body import TAN_SLOPE_LIMIT


class Ground(NamedTuple):
    """The terrain under a point: a plane, ``height + slope_x · dx + slope_z · dz``."""

    height: float  # m
    slope_x: float  # m up per m east
    slope_z: float  # m up per m north
    water: float  # m, the surface of the water over it, -inf where dry


@inlined_kernel
def ground_at(world: World, x: float, z: float) -> Ground:
    """Return the terrain at (x, z); outside the map, the outermost triangles extend."""
    row = cell_of(world.corner[1], z, world.water.shape[0])
    column = cell_of(world.corner[0], x, world.water.shape[1])
    east = (x - world.corner[0]) / CELL - column
    north = (z - world.corner[1]) / CELL - row
    h00, h01 = world.heights[row, column], world.heights[row, column + 1]
    h10, h11 = world.heights[row + 1, column], world.heights[row + 1, column + 1]
    if east >= north:  # the south-eastern triangle
        slope_east, slope_north = h01 - h00, h11 - h01
    else:
        slope_east, slope_north = h11 - h10, h10 - h00
    height = h00 + slope_east * east + slope_north * north
    surface = world.water[row, column]
    water = surface if surface > height else -np.inf
    return Ground(height, slope_east / CELL, slope_north / CELL, water)


@kernel
def water_at(world: World, x: float, z: float) -> float:
    """Return the height in m of the water surface at (x, z), -inf where dry."""
    return ground_at(world, x, z).water


@kernel
def is_steep(ground: Ground) -> bool:
    """Return whether ground is too steep to stand on."""
    steepness = ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z
    return bool(steepness > TAN_SLOPE_LIMIT * TAN_SLOPE_LIMIT)


def spread(heights: NDArray[np.float64], cells: int) -> NDArray[np.float64]:
    """Return the greatest height within some rows and columns of each, for (R, C) m; -inf without any."""
    nearby = heights.copy()
    for _ in range(cells):
        for part in (nearby, nearby.T):
            part[1:] = np.maximum(part[1:], part[:-1])
            part[:-1] = np.maximum(part[:-1], part[1:])
    return nearby
