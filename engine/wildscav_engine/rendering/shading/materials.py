"""The appearance of a map's surfaces, and what shades them: all that pictures need and that never changes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.rendering.palette import of_solids
from wildscav_engine.rendering.shading.column_index import columns_of
from wildscav_engine.rendering.shading.columns import Columns
from wildscav_engine.rendering.shading.ground import ground_appearance, packed_ground
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION, clouds

UP = (0.0, 1.0, 0.0)
UPRIGHT = 1e-6  # a face whose normal rises less than this stands upright


class Materials(NamedTuple):
    """The appearance of a map with S solids."""

    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255, unlit
    axis: NDArray[np.float64]  # (S, 2) level unit vector (x, z) that a solid's boards run along
    ground: NDArray[
        np.float32
    ]  # (R + 1, C + 1, 8) colour and normal of each cell corner; see ``packed_ground``
    to_sun: Columns  # all solids, towards the sun
    upwards: Columns  # floors and roofs
    clouds: NDArray[np.float32]  # see ``sky.clouds``


def materials_of(world: World, solid_house: NDArray[np.int16]) -> Materials:
    """Return the materials of a map.

    Args:
        solid_house: (S,) the house that a solid belongs to, -1 for none.
    """
    axis = np.empty((len(world.solid_kind), 2))
    _write_axes(world, axis)
    kinds = world.solid_kind
    return Materials(
        of_solids(kinds, solid_house),
        axis,
        packed_ground(ground_appearance(world)),
        columns_of(world, SUN_DIRECTION, np.ones(len(kinds), np.bool_), steep=True),
        columns_of(world, UP, (kinds == Kind.FLOOR) | (kinds == Kind.ROOF), steep=False),
        clouds(),
    )


@kernel
def _write_axes(world: World, axis: NDArray[np.float64]) -> None:
    """Write the normal of each solid's first upright face; east for solids without one."""
    for solid in range(axis.shape[0]):
        axis[solid, 0], axis[solid, 1] = 1.0, 0.0
        for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
            if abs(world.faces[face, 1]) < UPRIGHT:
                axis[solid, 0], axis[solid, 1] = world.faces[face, 0], world.faces[face, 2]
                break
