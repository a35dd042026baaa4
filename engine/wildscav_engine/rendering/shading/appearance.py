"""The materials of a map: the appearance of its surfaces, and what shades them.

They never change. Kernels that render pictures read them, with the static world, from one table of addresses.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.compilation.tables.array_tables import Addresses, addresses_of, reader
from wildscav_engine.geometry.world import Kind, World, empty_world
from wildscav_engine.rendering.palette import of_solids
from wildscav_engine.rendering.shading.ground import ground_appearance, packed_ground
from wildscav_engine.rendering.shading.light.columns import ShadowColumns, columns_of
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION, clouds

UP = (0.0, 1.0, 0.0)
UPRIGHT = 1e-6  # a face whose normal rises less than this stands upright


class Surfaces(NamedTuple):
    """The appearance of the surfaces of a map with S solids."""

    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255, unlit
    axis: NDArray[np.float64]  # (S, 2) level unit vector (x, z) that a solid's boards run along
    ground: NDArray[np.float32]  # (R + 1, C + 1, 8) of each cell corner; see ``packed_ground``
    clouds: NDArray[np.float32]  # see ``sky.clouds``


class Materials(NamedTuple):
    """The surfaces of a map, and what shades them."""

    surfaces: Surfaces
    to_sun: ShadowColumns  # all solids, towards the sun
    upwards: ShadowColumns  # floors and roofs


def materials_of(world: World, solid_house: NDArray[np.int16]) -> Materials:
    """Return the materials of a map."""
    axis = np.empty((len(world.solid_kind), 2))
    _write_axes(world, axis)
    kinds = world.solid_kind
    ground = packed_ground(ground_appearance(world))
    return Materials(
        Surfaces(of_solids(kinds, solid_house), axis, ground, clouds()),
        columns_of(world, SUN_DIRECTION, np.ones(len(kinds), np.bool_), steep=True),
        columns_of(world, UP, (kinds == Kind.FLOOR) | (kinds == Kind.ROOF), steep=False),
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


_FLOATS, _INTEGERS = np.zeros(0, np.float32), np.zeros(0, np.int32)
_read_world = reader(empty_world())
_read_surfaces = reader(
    Surfaces(
        np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((1, 1, 8), np.float32), np.zeros((0, 0), np.float32)
    )
)
_read_columns = reader(
    ShadowColumns(np.zeros(5), np.zeros((0, 0), np.int32), _FLOATS, _FLOATS, _INTEGERS, _INTEGERS)
)
SURFACES = len(World._fields)  # the row of a table where the surfaces begin; see ``Appearance``
TO_SUN = SURFACES + len(Surfaces._fields)
UPWARDS = TO_SUN + len(ShadowColumns._fields)


class Appearance:
    """The world of a map and its materials.

    Attributes:
        world: The static world.
        materials: Its materials.
        tables: (1, F, 6) the table of their arrays: the world, the surfaces, and both directions of columns.
    """

    def __init__(self, world: World, materials: Materials) -> None:
        """Build the table."""
        self.world, self.materials = world, materials
        self.tables = np.concatenate([addresses_of(part) for part in (world, *materials)])[np.newaxis]

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle only the arrays: the copies have other addresses."""
        return Appearance, (self.world, self.materials)


class Appearances:
    """The appearances of the maps that N images show, or of one for all.

    Attributes:
        tables: (N, F, 6) their tables.
    """

    def __init__(self, appearances: Sequence[Appearance]) -> None:
        """Collect appearances."""
        self._appearances = appearances  # keep the arrays alive
        self.tables = np.concatenate([appearance.tables for appearance in appearances])

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle only the appearances: the copies have other addresses."""
        return Appearances, (self._appearances,)


@inlined_kernel
def world_in(appearance: Addresses) -> World:
    """Return the static world in the table of an ``Appearance``."""
    world: World = _read_world(appearance[:SURFACES])
    return world


@inlined_kernel
def materials_in(appearance: Addresses) -> Materials:
    """Return the materials in the table of an ``Appearance``."""
    return Materials(
        _read_surfaces(appearance[SURFACES:TO_SUN]),
        _read_columns(appearance[TO_SUN:UPWARDS]),
        _read_columns(appearance[UPWARDS:]),
    )
