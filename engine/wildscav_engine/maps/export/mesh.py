"""The static world as triangle meshes: exactly the surface that motion, bullets and sight use.

These are for pictures and other programs; the game itself never reads them.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import CELL, Kind, World


class Mesh(NamedTuple):
    """A triangle mesh in the game's frame: V vertices, T triangles.

    The corners a, b, c of a triangle run so that the cross product of b - a and c - a points outwards:
    counter-clockwise seen from outside where the same three numbers are plotted in a right-handed frame.
    """

    vertices: NDArray[np.float32]  # (V, 3) m: x east, y up, z north
    triangles: NDArray[np.int32]  # (T, 3) vertices
    kinds: NDArray[np.int8]  # (T,) a Kind
    solids: NDArray[np.int32]  # (T,) the solid that a triangle belongs to, -1 for terrain and water


def terrain_mesh(world: World) -> Mesh:
    """Return the height field; its vertices are the cell corners, row after row northwards."""
    rows, columns = world.water.shape
    north, east = np.meshgrid(np.arange(rows + 1), np.arange(columns + 1), indexing="ij")
    x, z = world.corner[0] + CELL * east, world.corner[1] + CELL * north
    vertices = np.stack([x, world.heights, z], axis=-1).reshape(-1, 3)
    south_west = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    return _up_facing(vertices, south_west, columns + 1, Kind.TERRAIN)


def water_mesh(world: World) -> Mesh:
    """Return the water surface of every cell that is partly wet; the terrain hides the excess."""
    rows, columns = water_cells(world)
    vertices = np.empty((len(rows), 4, 3))
    vertices[:, :, 0] = world.corner[0] + CELL * (columns[:, None] + [0, 1, 0, 1])
    vertices[:, :, 1] = world.water[rows, columns][:, None]
    vertices[:, :, 2] = world.corner[1] + CELL * (rows[:, None] + [0, 0, 1, 1])
    return _up_facing(vertices.reshape(-1, 3), 4 * np.arange(len(rows)), 2, Kind.WATER)


def water_cells(world: World) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows and columns of the cells that are partly wet, (W,) each."""
    corners = world.heights
    lowest = np.minimum(
        np.minimum(corners[:-1, :-1], corners[:-1, 1:]), np.minimum(corners[1:, :-1], corners[1:, 1:])
    )
    rows, columns = np.nonzero(world.water > lowest)
    return rows, columns


def _up_facing(
    vertices: NDArray[np.float64], south_west: NDArray[np.int64], row_length: int, kind: Kind
) -> Mesh:
    """Split quads, given by their south-western vertices, as the height field does."""
    south_east, north_west = south_west + 1, south_west + row_length
    north_east = north_west + 1
    halves = [[south_west, north_east, south_east], [south_west, north_west, north_east]]
    triangles = np.array(halves, np.int32).transpose(2, 0, 1).reshape(-1, 3)
    return Mesh(
        vertices.astype(np.float32),
        np.ascontiguousarray(triangles),
        np.full(len(triangles), kind, np.int8),
        np.full(len(triangles), -1, np.int32),
    )


def solids_mesh(world: World, solids: Iterable[int] | None = None) -> Mesh:
    """Return the closed surfaces of the given solids, or of all; no two solids share a vertex."""
    chosen = range(len(world.solid_kind)) if solids is None else solids
    vertices, triangles, owners = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int32)]
    first = 0
    for solid in chosen:
        planes = world.faces[world.solid_start[solid] : world.solid_start[solid + 1]]
        corners, faces = polyhedron(planes)
        vertices.append(corners)
        triangles.append(faces + first)
        owners.append(np.full(len(faces), solid, np.int32))
        first += len(corners)
    owner = np.concatenate(owners)
    return Mesh(
        np.concatenate(vertices).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        world.solid_kind[owner],
        owner,
    )
