"""The static world as triangle meshes: the same surface that motion, bullets and sight meet.

An export, for pictures and other programs; the game itself never reads it.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Kind, World
from wildscav_engine.kernel import kernel

PARALLEL = 1e-9  # below this determinant, three unit normals do not make a corner
TOUCH = 1e-6  # m, how far from a plane a corner still lies on it


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
    """Return the level water of every cell that is wet somewhere; the terrain hides what is too much."""
    corners = world.heights
    lowest = np.minimum(
        np.minimum(corners[:-1, :-1], corners[:-1, 1:]), np.minimum(corners[1:, :-1], corners[1:, 1:])
    )
    rows, columns = np.nonzero(world.water > lowest)
    vertices = np.empty((len(rows), 4, 3))
    vertices[:, :, 0] = world.corner[0] + CELL * (columns[:, None] + [0, 1, 0, 1])
    vertices[:, :, 1] = world.water[rows, columns][:, None]
    vertices[:, :, 2] = world.corner[1] + CELL * (rows[:, None] + [0, 0, 1, 1])
    return _up_facing(vertices.reshape(-1, 3), 4 * np.arange(len(rows)), 2, Kind.WATER)


def _up_facing(
    vertices: NDArray[np.float64], south_west: NDArray[np.int64], row_length: int, kind: Kind
) -> Mesh:
    """Split quads, each named by its south-western vertex, as the height field does."""
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
    """Return the closed surfaces of some solids, or of all; no two solids share a vertex."""
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


@kernel
def polyhedron(planes: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the surface of the convex body under some planes.

    Every face is a loop over the same corners, so the surface is closed whatever the rounding.

    Args:
        planes: (F, 4) outward unit normals and offsets in m; one that touches the body at a corner or an
            edge only gives no triangle.

    Returns:
        Corners (V, 3) in m, and triangles (T, 3), outwards as ``Mesh`` has them. Both are empty if the
        planes enclose nothing.
    """
    corners = _corners(planes)
    triangles = np.empty((planes.shape[0] * max(0, len(corners) - 2), 3), np.int64)
    count = 0
    for face in range(planes.shape[0]):
        loop = _face_loop(planes[face], corners)
        for index in range(1, len(loop) - 1):
            triangles[count] = (loop[0], loop[index], loop[index + 1])
            count += 1
    return corners, triangles[:count].copy()


@kernel
def _corners(planes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points where three planes meet and no other cuts them off, each once."""
    faces = planes.shape[0]
    corners = np.empty((faces * (faces - 1) * (faces - 2) // 6, 3))
    count = 0
    for a in range(faces):
        for b in range(a + 1, faces):
            for c in range(b + 1, faces):
                found, x, y, z = _meeting_point(planes[a], planes[b], planes[c])
                if found and _inside(planes, x, y, z) and not _known(corners[:count], x, y, z):
                    corners[count] = (x, y, z)
                    count += 1
    return corners[:count].copy()


@kernel
def _meeting_point(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]
) -> tuple[bool, float, float, float]:
    """Solve three plane equations by Cramer's rule; False first if two planes are parallel."""
    bc_x, bc_y, bc_z = b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]
    determinant = a[0] * bc_x + a[1] * bc_y + a[2] * bc_z
    if abs(determinant) < PARALLEL:
        return False, 0.0, 0.0, 0.0
    ca_x, ca_y, ca_z = c[1] * a[2] - c[2] * a[1], c[2] * a[0] - c[0] * a[2], c[0] * a[1] - c[1] * a[0]
    ab_x, ab_y, ab_z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    x = (a[3] * bc_x + b[3] * ca_x + c[3] * ab_x) / determinant
    y = (a[3] * bc_y + b[3] * ca_y + c[3] * ab_y) / determinant
    z = (a[3] * bc_z + b[3] * ca_z + c[3] * ab_z) / determinant
    return True, x, y, z


@kernel
def _inside(planes: NDArray[np.float64], x: float, y: float, z: float) -> bool:
    for face in range(planes.shape[0]):
        if planes[face, 0] * x + planes[face, 1] * y + planes[face, 2] * z > planes[face, 3] + TOUCH:
            return False
    return True


@kernel
def _known(corners: NDArray[np.float64], x: float, y: float, z: float) -> bool:
    for corner in range(corners.shape[0]):
        apart = max(abs(corners[corner, 0] - x), abs(corners[corner, 1] - y), abs(corners[corner, 2] - z))
        if apart < 2.0 * TOUCH:
            return True
    return False


@kernel
def _face_loop(plane: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the corners on a plane in order about its normal; none if they span no area."""
    distance = corners[:, 0] * plane[0] + corners[:, 1] * plane[1] + corners[:, 2] * plane[2] - plane[3]
    loop = np.nonzero(np.abs(distance) <= 2.0 * TOUCH)[0]
    if len(loop) < 3:
        return loop[:0]
    middle = np.zeros(3)
    for corner in loop:
        middle += corners[corner] / len(loop)
    right = corners[loop[0]] - middle
    up_x = plane[1] * right[2] - plane[2] * right[1]
    up_y = plane[2] * right[0] - plane[0] * right[2]
    up_z = plane[0] * right[1] - plane[1] * right[0]
    turn = np.empty(len(loop))
    for index, corner in enumerate(loop):
        out = corners[corner] - middle
        along = out[0] * right[0] + out[1] * right[1] + out[2] * right[2]
        across = out[0] * up_x + out[1] * up_y + out[2] * up_z
        turn[index] = _turn(along, across)
    return loop[np.argsort(turn)]


@kernel
def _turn(along: float, across: float) -> float:
    """Return a number in [0, 4) that grows with the angle of a vector."""
    share = across / max(abs(along) + abs(across), 1e-300)
    if along < 0.0:
        return 2.0 - share
    return share if across >= 0.0 else 4.0 + share
