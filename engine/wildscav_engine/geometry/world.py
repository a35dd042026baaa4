"""The static world as arrays: a triangulated height field, convex solids, and one uniform grid over both."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.compilation.passed_tables import pass_as_table
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS

Corner = tuple[float, float, float] | NDArray[np.float64]  # m: x, y, z
CELL = 2.0  # m, side of a grid cell and of a terrain quad
BLOCK = 8  # cells along a side of a block, the coarser level of the grid
ARM = BODY_RADIUS + 0.25  # m; a body whose middle is in a cell reaches less far beyond it in one frame


class Kind(IntEnum):
    """The kind of a surface or solid."""

    NOTHING = 0
    TERRAIN = 1
    WATER = 2
    WALL = 3
    FLOOR = 4
    STAIR = 5
    ROOF = 6
    TRUNK = 7
    CROWN = 8
    ROCK = 9
    FURNITURE = 10
    BUSH = 11
    # Moving objects: they appear in images, but in no world.
    AGENT = 12
    SUPPLY_BOX = 13


@pass_as_table
class World(NamedTuple):
    """The static world of one map: R rows of cells northwards, C columns eastwards, S solids with F faces.

    The quad of cell (row, column) is split into two triangles along its diagonal from the south-west to the
    north-east corner. A solid is the set of points p with ``faces[:, :3] · p <= faces[:, 3]`` for all its
    faces.
    """

    corner: NDArray[np.float64]  # (2,) m, x and z of the south-west corner
    heights: NDArray[np.float64]  # (R + 1, C + 1) m, terrain at the cell corners
    water: NDArray[np.float64]  # (R, C) m, height of the water surface over a cell, -inf where dry
    cell_top: NDArray[np.float64]  # (R, C) m, highest point of terrain and solids in a cell
    block_top: NDArray[np.float64]  # (ceil(R / 8), ceil(C / 8)) m, the same for blocks of 8 × 8 cells
    cell_start: NDArray[np.int64]  # (R * C + 1,) where each cell's solids start in cell_solids
    # indices of solids, cell after cell; within a cell from the lowest upwards
    cell_solids: NDArray[np.int64]
    solid_low: NDArray[np.float64]  # (S, 3) m, least corner of the box around a solid
    solid_high: NDArray[np.float64]  # (S, 3) m, greatest corner
    solid_start: NDArray[np.int64]  # (S + 1,) where each solid's faces start in faces
    faces: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    face_reach: NDArray[np.float64]  # (F,) m, least distance of a body's position from each face
    solid_kind: NDArray[np.int8]  # (S,) a Kind
    spawns: NDArray[np.float64]  # (N, 3) m, where an agent may start or respawn
    # (R, C) m, lowest point of the solids that a body in a cell may touch, inf without any
    ceiling: NDArray[np.float64]


def empty_world() -> World:
    """Return a world of no cells and no solids: of each array, its dtype and its axes."""
    nothing, numbers = np.zeros((0, 0)), np.zeros(0, np.int64)
    return World(
        corner=np.zeros(2),
        heights=np.zeros((1, 1)),
        water=nothing,
        cell_top=nothing,
        block_top=nothing,
        cell_start=np.zeros(1, np.int64),
        cell_solids=numbers,
        solid_low=np.zeros((0, 3)),
        solid_high=np.zeros((0, 3)),
        solid_start=np.zeros(1, np.int64),
        faces=np.zeros((0, 4)),
        face_reach=np.zeros(0),
        solid_kind=np.zeros(0, np.int8),
        spawns=np.zeros((0, 3)),
        ceiling=nothing,
    )


@dataclass(frozen=True)
class Solid:
    """One convex polyhedron."""

    kind: Kind
    planes: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    low: NDArray[np.float64]  # (3,) m
    high: NDArray[np.float64]  # (3,) m


def convex_solid(
    kind: Kind, vertices: NDArray[np.float64], faces: Sequence[Sequence[int]] | NDArray[np.int64]
) -> Solid:
    """Make a solid from its corners and, for each flat face, the indices of at least three of its corners.

    The corners of a face may be given in either direction: normals are made to point away from the mean of
    all corners. The first three corners of a face must not lie on one line.
    """
    triples = faces if isinstance(faces, np.ndarray) else np.array([face[:3] for face in faces], np.int64)
    planes = _planes_of(vertices, triples)
    return Solid(kind, planes, vertices.min(axis=0), vertices.max(axis=0))


@array_kernel
def _planes_of(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    middle_x, middle_y, middle_z = 0.0, 0.0, 0.0
    for row in range(vertices.shape[0]):
        middle_x += vertices[row, 0]
        middle_y += vertices[row, 1]
        middle_z += vertices[row, 2]
    middle_x /= vertices.shape[0]
    middle_y /= vertices.shape[0]
    middle_z /= vertices.shape[0]
    planes = np.empty((faces.shape[0], 4))
    for row in range(faces.shape[0]):
        a, b, c = vertices[faces[row, 0]], vertices[faces[row, 1]], vertices[faces[row, 2]]
        write_plane(a, b, c, (middle_x, middle_y, middle_z), planes[row])
    return planes


@kernel
def set_plane(plane: NDArray[np.float64], x: float, y: float, z: float, offset: float) -> None:
    """Write a plane (4,): its normal and its offset in m.

    Assigning a tuple instead would compile much of Numba's own code, which checks the length and formats
    errors.
    """
    plane[0], plane[1], plane[2], plane[3] = x, y, z, offset


@kernel
def write_plane(a: Corner, b: Corner, c: Corner, behind: Corner, plane: NDArray[np.float64]) -> None:
    """Write the unit normal and the offset in m of the plane through a, b and c, given a point behind it."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = np.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    offset = x * a[0] + y * a[1] + z * a[2]
    sign = -1.0 if x * behind[0] + y * behind[1] + z * behind[2] > offset else 1.0
    plane[0], plane[1], plane[2], plane[3] = sign * x, sign * y, sign * z, sign * offset


def build_world(
    corner: tuple[float, float],
    heights: NDArray[np.float64],
    water: NDArray[np.float64],
    solids: Sequence[Solid],
    spawns: NDArray[np.float64],
) -> World:
    """Index terrain and solids, but not their parts beyond the grid; for the arrays, see ``World``."""
    rows, columns = water.shape
    low = np.array([solid.low for solid in solids], np.float64).reshape(-1, 3)
    high = np.array([solid.high for solid in solids], np.float64).reshape(-1, 3)
    face_counts = [0] + [len(solid.planes) for solid in solids]
    faces = np.concatenate([solid.planes for solid in solids]) if solids else np.zeros((0, 4))
    corner_array = np.array(corner, np.float64)
    upwards = np.argsort(low[:, 1], kind="stable")
    cell_start, cell_solids = _index_solids(corner_array, rows, columns, low, high, upwards)
    cell_top = _top_of_cells(heights, cell_start, cell_solids, high)
    return World(
        corner=corner_array,
        heights=np.ascontiguousarray(heights, np.float64),
        water=np.ascontiguousarray(water, np.float64),
        cell_top=cell_top,
        block_top=_top_of_blocks(cell_top),
        cell_start=cell_start,
        cell_solids=cell_solids,
        solid_low=low,
        solid_high=high,
        solid_start=np.cumsum(face_counts).astype(np.int64),
        faces=np.ascontiguousarray(faces),
        face_reach=_reach_of_body(faces),
        solid_kind=np.array([solid.kind for solid in solids], np.int8),
        spawns=np.ascontiguousarray(spawns, np.float64).reshape(-1, 3),
        ceiling=_ceiling_of_cells(corner_array, rows, columns, low, high),
    )


def _reach_of_body(faces: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance from each face's plane at which an upright cylinder just touches it.

    The position of a body is the middle of its soles, so its head touches a face that looks down.
    """
    across = np.sqrt(faces[:, 0] * faces[:, 0] + faces[:, 2] * faces[:, 2])
    return BODY_RADIUS * across + BODY_HEIGHT * np.maximum(0.0, -faces[:, 1])


@kernel
def cell_of(corner: float, coordinate: float, count: int) -> int:
    """Return the row or column of a coordinate; outside the map, the nearest one."""
    return min(count - 1, max(0, int(np.floor((coordinate - corner) / CELL))))


@array_kernel
def _index_solids(
    corner: NDArray[np.float64],
    rows: int,
    columns: int,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    upwards: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """List, for each cell, the solids whose boxes touch it (a counting sort).

    Within a cell they are in the order of ``upwards``, by their lowest points, so that a search for obstacles
    can stop at the first solid above a body's head.
    """
    start = np.zeros(rows * columns + 1, np.int64)
    for fill in range(2):
        if fill == 0:
            items = np.zeros(0, np.int64)
        else:
            for cell in range(rows * columns):
                start[cell + 1] += start[cell]
            items = np.empty(start[rows * columns], np.int64)
            written = start[:-1].copy()
        for solid in upwards:
            for row in range(
                cell_of(corner[1], low[solid, 2], rows), cell_of(corner[1], high[solid, 2], rows) + 1
            ):
                for column in range(
                    cell_of(corner[0], low[solid, 0], columns),
                    cell_of(corner[0], high[solid, 0], columns) + 1,
                ):
                    cell = row * columns + column
                    if fill == 0:
                        start[cell + 1] += 1
                    else:
                        items[written[cell]] = solid
                        written[cell] += 1
    return start, items


@array_kernel
def _top_of_cells(
    heights: NDArray[np.float64],
    cell_start: NDArray[np.int64],
    cell_solids: NDArray[np.int64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    top = np.empty((rows, columns))
    for row in range(rows):
        for column in range(columns):
            south = max(heights[row, column], heights[row, column + 1])
            north = max(heights[row + 1, column], heights[row + 1, column + 1])
            highest = max(south, north)
            cell = row * columns + column
            for item in range(cell_start[cell], cell_start[cell + 1]):
                highest = max(highest, high[cell_solids[item], 1])
            top[row, column] = highest
    return top


@array_kernel
def _ceiling_of_cells(
    corner: NDArray[np.float64],
    rows: int,
    columns: int,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return (R, C) m, the lowest point of all solids less than ARM away from each cell."""
    ceiling = np.full((rows, columns), np.inf)
    for solid in range(low.shape[0]):
        south, north = low[solid, 2] - ARM, high[solid, 2] + ARM
        west, east = low[solid, 0] - ARM, high[solid, 0] + ARM
        for row in range(cell_of(corner[1], south, rows), cell_of(corner[1], north, rows) + 1):
            for column in range(cell_of(corner[0], west, columns), cell_of(corner[0], east, columns) + 1):
                ceiling[row, column] = min(ceiling[row, column], low[solid, 1])
    return ceiling


@array_kernel
def _top_of_blocks(cell_top: NDArray[np.float64]) -> NDArray[np.float64]:
    rows, columns = cell_top.shape
    top = np.full(((rows + BLOCK - 1) // BLOCK, (columns + BLOCK - 1) // BLOCK), -np.inf)
    for row in range(rows):
        for column in range(columns):
            block = (row // BLOCK, column // BLOCK)
            top[block] = max(top[block], cell_top[row, column])
    return top
