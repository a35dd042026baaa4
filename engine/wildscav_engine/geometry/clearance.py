"""Tests of whether a body fits at a place."""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS

CLEARANCE = 0.05  # m kept free around a body that stands somewhere, and below and above it


@kernel
def is_clear(world: World, x: float, y: float, z: float) -> bool:
    """Return whether a body that stands at a place in m touches no solid; the terrain is not tested."""
    return has_clearance(world, x, y, z, CLEARANCE)


@kernel
def has_clearance(world: World, x: float, y: float, z: float, margin: float) -> bool:
    """Return whether a body at a place in m stays at least ``margin`` m away from every solid beside it."""
    return is_free(world, x, y + CLEARANCE, y + BODY_HEIGHT + CLEARANCE, z, margin)


@kernel
def is_free(world: World, x: float, low: float, high: float, z: float, margin: float) -> bool:
    """Return whether an upright cylinder, ``margin`` m wider than a body, touches no solid."""
    rows, columns = world.water.shape
    radius = BODY_RADIUS + margin
    for row in range(
        cell_of(world.corner[1], z - radius, rows), cell_of(world.corner[1], z + radius, rows) + 1
    ):
        for column in range(
            cell_of(world.corner[0], x - radius, columns), cell_of(world.corner[0], x + radius, columns) + 1
        ):
            cell = row * columns + column
            for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
                solid = world.cell_solids[item]
                if world.solid_low[solid, 1] >= high:
                    break  # all solids after it begin higher still
                if low < world.solid_high[solid, 1] and _touches(world, solid, x, z, radius, low, high):
                    return False
    return True


@kernel
def _touches(world: World, solid: int, x: float, z: float, radius: float, low: float, high: float) -> bool:
    """Return whether an upright cylinder overlaps a solid: all its faces and its bounding box.

    The caller has already checked that they overlap in height.
    """
    least, most = world.solid_low[solid], world.solid_high[solid]
    if x - radius >= most[0] or x + radius <= least[0] or z - radius >= most[2] or z + radius <= least[2]:
        return False
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n_x, n_y, n_z = world.faces[face, 0], world.faces[face, 1], world.faces[face, 2]
        y = low if n_y > 0.0 else high
        reach = radius * np.sqrt(n_x * n_x + n_z * n_z)
        if n_x * x + n_y * y + n_z * z - reach >= world.faces[face, 3]:
            return False
    return True
