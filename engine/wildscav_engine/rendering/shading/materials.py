"""The appearance of a map's surfaces: the colour and grain direction of each solid, and the ground."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.palette import of_solids
from wildscav_engine.rendering.shading.ground import GroundAppearance, ground_appearance

UPRIGHT = 1e-6  # a face whose normal rises less than this stands upright


class Materials(NamedTuple):
    """The appearance of a map with S solids."""

    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255, unlit
    axis: NDArray[np.float64]  # (S, 2) level unit vector (x, z) that a solid's boards run along
    ground: GroundAppearance


def materials_of(world: World, solid_house: NDArray[np.int16]) -> Materials:
    """Return the materials of a map.

    Args:
        world: Of the map.
        solid_house: (S,) the house that a solid belongs to, -1 for none.
    """
    axis = np.empty((len(world.solid_kind), 2))
    _write_axes(world, axis)
    return Materials(of_solids(world.solid_kind, solid_house), axis, ground_appearance(world))


@kernel
def _write_axes(world: World, axis: NDArray[np.float64]) -> None:
    """Write the normal of each solid's first upright face; east for solids without one."""
    for solid in range(axis.shape[0]):
        axis[solid, 0], axis[solid, 1] = 1.0, 0.0
        for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
            if abs(world.faces[face, 1]) < UPRIGHT:
                axis[solid, 0], axis[solid, 1] = world.faces[face, 0], world.faces[face, 2]
                break
