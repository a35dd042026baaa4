"""Preparing the columns of a map; see ``columns.py``."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.rendering.shading.columns import STEEP, Columns

SIDE = 0.5  # m, of a column's section
MAX_COLUMNS = 2**23  # columns; wider ones are made for a map that would have more
LEVEL = 1e-9  # a face whose unit normal is this close to level across the direction runs along it
MARGIN = 1e-3  # m, for rounding


def columns_of(
    world: World, direction: tuple[float, float, float], chosen: NDArray[np.bool_], *, steep: bool
) -> Columns:
    """Return the columns of a map along a direction.

    Args:
        direction: It points upwards.
        chosen: (S,) which solids block it.
        steep: Whether the ground may block it as well.
    """
    lean_x, lean_z = direction[0] / direction[1], direction[2] / direction[1]
    west, east = _span(world, 0, lean_x)
    south, north = _span(world, 2, lean_z)
    side = max(SIDE, float(np.sqrt((east - west) * (north - south) / MAX_COLUMNS)))
    shape = int((north - south) / side) + 1, int((east - west) / side) + 1
    nothing, number = np.zeros(0, np.float32), np.zeros(0, np.int32)
    bare = Columns(
        lean_x, lean_z, west, south, 1.0 / side, np.zeros(shape, np.int32), nothing, nothing, number, number
    )
    solids = np.nonzero(chosen)[0]
    planes = np.empty((int(np.diff(world.solid_start).max(initial=0)) ** 2 + 1, 3))
    counts = np.zeros(shape, np.int32)
    _visit(world, solids, steep, bare, planes, counts, False)
    occupied = counts > 0
    total = int(np.count_nonzero(occupied))
    bare.record[occupied] = np.arange(1, total + 1, dtype=np.int32)
    start = np.concatenate([[0, 0], np.cumsum(counts[occupied])]).astype(np.int32)
    columns = bare._replace(
        clear=np.full(1 + total, -np.inf, np.float32),
        closed=np.full(1 + total, -np.inf, np.float32),
        start=start,
        solids=np.empty(start[-1], np.int32),
    )
    _visit(world, solids, steep, columns, planes, counts, True)
    return columns


def _span(world: World, axis: int, lean: float) -> tuple[float, float]:
    """Return the least and the greatest coordinate that the columns of a world have on one axis, m."""
    size = CELL * world.water.shape[1 if axis == 0 else 0]
    corner = world.corner[0 if axis == 0 else 1]
    low = np.array([corner, *world.solid_low[:, axis]]).min()
    high = np.array([corner + size, *world.solid_high[:, axis]]).max()
    bottom = min(world.heights.min(), world.solid_low[:, 1].min(initial=np.inf))
    top = max(world.heights.max(), world.solid_high[:, 1].max(initial=-np.inf))
    leans = lean * bottom, lean * top
    return float(low - max(leans) - 1.0), float(high - min(leans) + 1.0)


@kernel
def _visit(
    world: World,
    solids: NDArray[np.int64],
    steep: bool,
    columns: Columns,
    planes: NDArray[np.float64],
    counts: NDArray[np.int32],
    fill: bool,
) -> None:
    """Count what is in each column, or else fill the columns with it, while counting back.

    Args:
        planes: (N, 3) scratch buffer.
        counts: (R, C) of items in each column, written.
    """
    # Solids are filled in first, from the back, so that steep ground comes first in its column.
    for solid in solids:
        _visit_solid(world, solid, columns, planes, counts, fill)
    if steep:
        _visit_ground(world, columns, counts, fill)


@inlined_kernel
def _visit_solid(
    world: World,
    solid: int,
    columns: Columns,
    planes: NDArray[np.float64],
    counts: NDArray[np.int32],
    fill: bool,
) -> None:
    low, high = world.solid_low[solid], world.solid_high[solid]
    west = low[0] - max(columns.lean_x * low[1], columns.lean_x * high[1])
    east = high[0] - min(columns.lean_x * low[1], columns.lean_x * high[1])
    south = low[2] - max(columns.lean_z * low[1], columns.lean_z * high[1])
    north = high[2] - min(columns.lean_z * low[1], columns.lean_z * high[1])
    count = _outline(world, solid, columns, planes)
    half = 0.5 / columns.per_side
    for row in range(_row_of(columns, south), _row_of(columns, north) + 1):
        z = columns.south + (2 * row + 1) * half
        for column in range(_column_of(columns, west), _column_of(columns, east) + 1):
            x = columns.west + (2 * column + 1) * half
            if not _overlaps(planes, count, x, z, half):
                continue
            counts[row, column] += -1 if fill else 1
            if fill:
                record = columns.record[row, column]
                columns.solids[columns.start[record] + counts[row, column]] = solid
                columns.clear[record] = max(columns.clear[record], np.float32(high[1] + MARGIN))
                under = np.float32(_least_top(world, solid, columns, x, z, half) - MARGIN)
                columns.closed[record] = max(columns.closed[record], under)


@inlined_kernel
def _visit_ground(world: World, columns: Columns, counts: NDArray[np.int32], fill: bool) -> None:
    """Visit the columns that cross ground that faces away from the direction."""
    rows, width = world.water.shape
    for row in range(rows):
        for column in range(width):
            h00, h01 = world.heights[row, column], world.heights[row, column + 1]
            h10, h11 = world.heights[row + 1, column], world.heights[row + 1, column + 1]
            first = CELL - (h01 - h00) * columns.lean_x - (h11 - h01) * columns.lean_z
            second = CELL - (h11 - h10) * columns.lean_x - (h10 - h00) * columns.lean_z
            if min(first, second) > LEVEL:
                continue
            bottom, top = min(h00, h01, h10, h11), max(h00, h01, h10, h11)
            x, z = world.corner[0] + CELL * column, world.corner[1] + CELL * row
            west = x - max(columns.lean_x * bottom, columns.lean_x * top)
            east = x + CELL - min(columns.lean_x * bottom, columns.lean_x * top)
            south = z - max(columns.lean_z * bottom, columns.lean_z * top)
            north = z + CELL - min(columns.lean_z * bottom, columns.lean_z * top)
            for r in range(_row_of(columns, south), _row_of(columns, north) + 1):
                for c in range(_column_of(columns, west), _column_of(columns, east) + 1):
                    counts[r, c] += -1 if fill else 1
                    if fill:
                        record = columns.record[r, c]
                        columns.solids[columns.start[record] + counts[r, c]] = STEEP
                        columns.clear[record] = np.inf


@inlined_kernel
def _row_of(columns: Columns, z: float) -> int:
    return int(min(columns.record.shape[0] - 1, max(0, np.floor((z - columns.south) * columns.per_side))))


@inlined_kernel
def _column_of(columns: Columns, x: float) -> int:
    return int(min(columns.record.shape[1] - 1, max(0, np.floor((x - columns.west) * columns.per_side))))


@inlined_kernel
def _outline(world: World, solid: int, columns: Columns, planes: NDArray[np.float64]) -> int:
    """Write the lines around a solid's shadow along the direction, and return how many there are.

    A line (a, b, c) has the shadow on its side a · x + b · z <= c. The height is eliminated from the solid's
    planes, pair by pair: Fourier, "Solution d'une question particulière du calcul des inégalités", 1826.
    """
    first, last = world.solid_start[solid], world.solid_start[solid + 1]
    count = 0
    for over in range(first, last):
        above = _speed(world, over, columns)
        if abs(above) <= LEVEL:
            planes[count, 0], planes[count, 1] = world.faces[over, 0], world.faces[over, 2]
            planes[count, 2] = world.faces[over, 3] + MARGIN
            count += 1
        if above <= LEVEL:
            continue
        for under in range(first, last):
            below = -_speed(world, under, columns)
            if below > LEVEL:
                a = below * world.faces[over, 0] + above * world.faces[under, 0]
                b = below * world.faces[over, 2] + above * world.faces[under, 2]
                c = below * world.faces[over, 3] + above * world.faces[under, 3]
                planes[count, 0], planes[count, 1], planes[count, 2] = a, b, c + MARGIN * (below + above)
                count += 1
    return count


@inlined_kernel
def _speed(world: World, face: int, columns: Columns) -> float:
    """Return how fast the direction leaves a face behind, m per m upwards."""
    faces = world.faces
    return float(faces[face, 0] * columns.lean_x + faces[face, 1] + faces[face, 2] * columns.lean_z)


@inlined_kernel
def _overlaps(planes: NDArray[np.float64], count: int, x: float, z: float, half: float) -> bool:
    """Return whether a shadow may reach into the square with a middle and half a side."""
    for plane in range(count):
        a, b = planes[plane, 0], planes[plane, 1]
        if a * x + b * z - half * (abs(a) + abs(b)) > planes[plane, 2]:
            return False
    return True


@inlined_kernel
def _least_top(world: World, solid: int, columns: Columns, x: float, z: float, half: float) -> float:
    """Return the least height in m at which a column leaves a solid; -inf if some of it passes by.

    The top of a convex solid is lowest at one of the corners of the column.
    """
    least = np.inf
    for corner in range(4):
        at_x = x + (half if corner & 1 else -half)
        at_z = z + (half if corner & 2 else -half)
        bottom, top = -np.inf, np.inf
        for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
            speed = _speed(world, face, columns)
            rest = world.faces[face, 3] - world.faces[face, 0] * at_x - world.faces[face, 2] * at_z
            if speed > LEVEL:
                top = min(top, rest / speed)
            elif speed < -LEVEL:
                bottom = max(bottom, rest / speed)
            elif rest < 0.0:
                return -np.inf
        if bottom > top:
            return -np.inf
        least = min(least, top)
    return least
