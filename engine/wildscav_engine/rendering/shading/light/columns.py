"""What stands in the way along one fixed direction: towards the sun for shadows, upwards for roofs.

Neither the sun nor the static world moves, so what blocks a direction is prepared once for a map. Space is
divided into columns that run along the direction and have square sections on the ground. A column knows the
height above which it is clear, the height below which a solid closes it completely, and which solids reach
into it. Most questions are answered by the two heights; the others meet only the solids of one column.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.rendering.shading.color_arithmetic import Vector, dot
from wildscav_engine.rendering.shading.pixel_rows import Places
from wildscav_engine.rendering.tracing.frustum import nonnegative

CLEAR, BLOCKED, UNKNOWN = 0, 1, 2  # what is known about the way from a place
OUTSIDE, NONE = np.float32(-1.0), np.float32(0.0)  # the row of places that belong to no column
LEAN_X, LEAN_Z, WEST, SOUTH, PER_SIDE = range(5)  # of the grid of columns
STEEP = -1  # stands for ground that may shade itself, among the solids of a column
SIDE = 0.5  # m, of a column's section
MAX_COLUMNS = 2**23  # columns; wider ones are made for a map that would have more
LEVEL = 1e-9  # a face whose unit normal is this close to level across the direction runs along it
MARGIN = 1e-3  # m, for rounding


class ShadowColumns(NamedTuple):
    """R by C columns along one direction, N of which have solids in them.

    A place belongs to the column of its coordinates (x - lean_x · y, z - lean_z · y).
    """

    # (5,) m east and m north per m upwards; m, the least coordinates of any column; columns per m
    grid: NDArray[np.float64]
    record: NDArray[np.int32]  # (R, C) the row of a column in the following; 0 for columns without solids
    clear: NDArray[np.float32]  # (1 + N,) m, height from which on nothing blocks the direction
    closed: NDArray[np.float32]  # (1 + N,) m, height below which one solid blocks all of it, -inf for none
    start: NDArray[np.int32]  # (2 + N,) where the solids of each record start
    solids: NDArray[np.int32]  # indices of solids, or STEEP


@inlined_kernel
def is_blocked(columns: ShadowColumns, world: World, place: Vector) -> int:
    """Return whether a solid blocks the way from a place along the direction.

    Args:
        place: m, in the open air or in a solid, but above the ground.

    Returns:
        CLEAR, BLOCKED, or UNKNOWN where steep ground may block it.
    """
    x, y, z = place
    across = (x - columns.grid[LEAN_X] * y - columns.grid[WEST]) * columns.grid[PER_SIDE]
    along = (z - columns.grid[LEAN_Z] * y - columns.grid[SOUTH]) * columns.grid[PER_SIDE]
    rows, width = columns.record.shape
    if not (0.0 <= across < width and 0.0 <= along < rows):
        return CLEAR
    return blocked_in(columns, world, int(along), int(across), place)


@disjoint_kernel
def write_columns(
    columns: ShadowColumns, places: Places, rows: NDArray[np.int32], numbers: NDArray[np.int32]
) -> None:
    """Write which columns places belong to, as rows, OUTSIDE for none, and numbers in them."""
    lean_x, lean_z = np.float32(columns.grid[LEAN_X]), np.float32(columns.grid[LEAN_Z])
    west, south, per_side = (
        np.float32(columns.grid[WEST]),
        np.float32(columns.grid[SOUTH]),
        np.float32(columns.grid[PER_SIDE]),
    )
    height, width = np.float32(columns.record.shape[0]), np.float32(columns.record.shape[1])
    for place in range(rows.shape[0]):
        x, y, z = places.x[place], places.y[place], places.z[place]
        across, along = (x - lean_x * y - west) * per_side, (z - lean_z * y - south) * per_side
        is_in = (across >= NONE) & (across < width) & (along >= NONE) & (along < height)
        rows[place] = np.int32(along if is_in else OUTSIDE)
        numbers[place] = np.int32(across if is_in else NONE)


@inlined_kernel
def blocked_in(columns: ShadowColumns, world: World, row: int, number: int, place: Vector) -> int:
    """Return the same as ``is_blocked``, given the row and the number of the column of the place."""
    y, record = place[1], columns.record[nonnegative(row), nonnegative(number)]
    if record == 0 or y >= columns.clear[record]:
        return CLEAR
    if y < columns.closed[record]:
        return BLOCKED
    for item in range(columns.start[record], columns.start[record + 1]):
        solid = columns.solids[item]
        if solid == STEEP:
            return UNKNOWN
        if world.solid_high[solid, 1] >= y and _is_met(columns, world, solid, place):
            return BLOCKED
    return CLEAR


@inlined_kernel
def _is_met(columns: ShadowColumns, world: World, solid: int, place: Vector) -> bool:
    """Return whether a ray along the direction meets a solid."""
    first, last = world.solid_start[solid], world.solid_start[solid + 1]
    upwards = (columns.grid[LEAN_X], 1.0, columns.grid[LEAN_Z])
    enter, leave = clip_ray(world.faces, first, last, place, upwards)
    return enter <= leave


@inlined_kernel
def clip_ray(
    faces: NDArray[np.float64], first: int, last: int, place: Vector, direction: Vector
) -> tuple[float, float]:
    """Return where a ray enters and leaves a solid, clipped as in ``geometry.rays.intersect_faces``.

    The numbers are multiples of the direction's length. A ray that misses the solid leaves before it enters.
    """
    enter, leave = 0.0, np.inf
    for face in range(first, last):
        normal = (faces[face, 0], faces[face, 1], faces[face, 2])
        outside, speed = dot(normal, place) - faces[face, 3], dot(normal, direction)
        if speed < 0.0:
            enter = max(enter, -outside / speed)
        elif outside > 0.0:
            return np.inf, 0.0
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
        if enter > leave:
            break
    return enter, leave


def columns_of(
    world: World, direction: tuple[float, float, float], chosen: NDArray[np.bool_], *, steep: bool
) -> ShadowColumns:
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
    bare = ShadowColumns(
        np.array([lean_x, lean_z, west, south, 1.0 / side]),
        np.zeros(shape, np.int32),
        *(nothing, nothing, number, number),
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
    columns: ShadowColumns,
    planes: NDArray[np.float64],
    counts: NDArray[np.int32],
    fill: bool,
) -> None:
    """Count what is in each column, or else fill the columns with it, while counting back."""
    # Solids are filled in first, from the back, so that steep ground comes first in its column.
    for solid in solids:
        _visit_solid(world, solid, columns, planes, counts, fill)
    if steep:
        _visit_ground(world, columns, counts, fill)


@inlined_kernel
def _visit_solid(
    world: World,
    solid: int,
    columns: ShadowColumns,
    planes: NDArray[np.float64],
    counts: NDArray[np.int32],
    fill: bool,
) -> None:
    low, high = world.solid_low[solid], world.solid_high[solid]
    west, east = span_along(columns.grid[LEAN_X], low[0], high[0], low[1], high[1])
    south, north = span_along(columns.grid[LEAN_Z], low[2], high[2], low[1], high[1])
    count = _outline(world, solid, columns, planes)
    half = 0.5 / columns.grid[PER_SIDE]
    for row in range(_row_of(columns, south), _row_of(columns, north) + 1):
        z = columns.grid[SOUTH] + (2 * row + 1) * half
        for column in range(_column_of(columns, west), _column_of(columns, east) + 1):
            x = columns.grid[WEST] + (2 * column + 1) * half
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
def _visit_ground(world: World, columns: ShadowColumns, counts: NDArray[np.int32], fill: bool) -> None:
    """Visit the columns that cross ground that faces away from the direction."""
    rows, width = world.water.shape
    for row in range(rows):
        for column in range(width):
            h00, h01 = world.heights[row, column], world.heights[row, column + 1]
            h10, h11 = world.heights[row + 1, column], world.heights[row + 1, column + 1]
            first = CELL - (h01 - h00) * columns.grid[LEAN_X] - (h11 - h01) * columns.grid[LEAN_Z]
            second = CELL - (h11 - h10) * columns.grid[LEAN_X] - (h10 - h00) * columns.grid[LEAN_Z]
            if min(first, second) > LEVEL:
                continue
            bottom, top = min(h00, h01, h10, h11), max(h00, h01, h10, h11)
            x, z = world.corner[0] + CELL * column, world.corner[1] + CELL * row
            west, east = span_along(columns.grid[LEAN_X], x, x + CELL, bottom, top)
            south, north = span_along(columns.grid[LEAN_Z], z, z + CELL, bottom, top)
            for r in range(_row_of(columns, south), _row_of(columns, north) + 1):
                for c in range(_column_of(columns, west), _column_of(columns, east) + 1):
                    counts[r, c] += -1 if fill else 1
                    if fill:
                        record = columns.record[r, c]
                        columns.solids[columns.start[record] + counts[r, c]] = STEEP
                        columns.clear[record] = np.inf


@inlined_kernel
def span_along(lean: float, low: float, high: float, bottom: float, top: float) -> tuple[float, float]:
    """Return the least and the greatest coordinate of the columns of a box on one axis, m."""
    return low - max(lean * bottom, lean * top), high - min(lean * bottom, lean * top)


@inlined_kernel
def _row_of(columns: ShadowColumns, z: float) -> int:
    return int(
        min(columns.record.shape[0] - 1, max(0, np.floor((z - columns.grid[SOUTH]) * columns.grid[PER_SIDE])))
    )


@inlined_kernel
def _column_of(columns: ShadowColumns, x: float) -> int:
    return int(
        min(columns.record.shape[1] - 1, max(0, np.floor((x - columns.grid[WEST]) * columns.grid[PER_SIDE])))
    )


@inlined_kernel
def _outline(world: World, solid: int, columns: ShadowColumns, planes: NDArray[np.float64]) -> int:
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
def _speed(world: World, face: int, columns: ShadowColumns) -> float:
    """Return how fast the direction leaves a face behind, m per m upwards."""
    faces = world.faces
    return float(
        faces[face, 0] * columns.grid[LEAN_X] + faces[face, 1] + faces[face, 2] * columns.grid[LEAN_Z]
    )


@inlined_kernel
def _overlaps(planes: NDArray[np.float64], count: int, x: float, z: float, half: float) -> bool:
    """Return whether a shadow may reach into the square with a middle and half a side."""
    for plane in range(count):
        a, b = planes[plane, 0], planes[plane, 1]
        if a * x + b * z - half * (abs(a) + abs(b)) > planes[plane, 2]:
            return False
    return True


@inlined_kernel
def _least_top(world: World, solid: int, columns: ShadowColumns, x: float, z: float, half: float) -> float:
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
