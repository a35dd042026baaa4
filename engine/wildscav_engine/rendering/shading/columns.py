"""What stands in the way along one fixed direction: towards the sun for shadows, upwards for roofs.

Neither the sun nor the static world moves, so what blocks a direction is prepared once for a map. Space is
divided into columns that run along the direction and have square sections on the ground. A column knows the
height above which it is clear, the height below which a solid closes it completely, and which solids reach
into it. Most questions are answered by the two heights; the others meet only the solids of one column.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.pixel_rows import Places
from wildscav_engine.rendering.tracing.frustum import nonnegative

CLEAR, BLOCKED, UNKNOWN = 0, 1, 2  # what is known about the way from a place
OUTSIDE, NONE = np.float32(-1.0), np.float32(0.0)  # the row of places that belong to no column
STEEP = -1  # stands for ground that may shade itself, among the solids of a column


class Columns(NamedTuple):
    """R by C columns along one direction, N of which have solids in them.

    A place belongs to the column of its coordinates (x - lean_x · y, z - lean_z · y).
    """

    lean_x: float  # m east per m upwards along the direction
    lean_z: float  # m north
    west: float  # m, the least first coordinate of any column
    south: float  # m, the least second coordinate
    per_side: float  # columns per m
    record: NDArray[np.int32]  # (R, C) the row of a column in the following; 0 for columns without solids
    clear: NDArray[np.float32]  # (1 + N,) m, height from which on nothing blocks the direction
    closed: NDArray[np.float32]  # (1 + N,) m, height below which one solid blocks all of it, -inf for none
    start: NDArray[np.int32]  # (2 + N,) where the solids of each record start
    solids: NDArray[np.int32]  # indices of solids, or STEEP


@inlined_kernel
def is_blocked(columns: Columns, world: World, place: Vector) -> int:
    """Return whether a solid blocks the way from a place along the direction.

    Args:
        place: m, in the open air or in a solid, but above the ground.

    Returns:
        CLEAR, BLOCKED, or UNKNOWN where steep ground may block it.
    """
    x, y, z = place
    across = (x - columns.lean_x * y - columns.west) * columns.per_side
    along = (z - columns.lean_z * y - columns.south) * columns.per_side
    rows, width = columns.record.shape
    if not (0.0 <= across < width and 0.0 <= along < rows):
        return CLEAR
    return blocked_in(columns, world, int(along), int(across), place)


@disjoint_kernel
def write_columns(
    columns: Columns, places: Places, rows: NDArray[np.int32], numbers: NDArray[np.int32]
) -> None:
    """Write which columns places belong to, as rows, OUTSIDE for none, and numbers in them."""
    lean_x, lean_z = np.float32(columns.lean_x), np.float32(columns.lean_z)
    west, south, per_side = np.float32(columns.west), np.float32(columns.south), np.float32(columns.per_side)
    height, width = np.float32(columns.record.shape[0]), np.float32(columns.record.shape[1])
    for place in range(rows.shape[0]):
        x, y, z = places.x[place], places.y[place], places.z[place]
        across, along = (x - lean_x * y - west) * per_side, (z - lean_z * y - south) * per_side
        is_in = (across >= NONE) & (across < width) & (along >= NONE) & (along < height)
        rows[place] = np.int32(along if is_in else OUTSIDE)
        numbers[place] = np.int32(across if is_in else NONE)


@inlined_kernel
def blocked_in(columns: Columns, world: World, row: int, number: int, place: Vector) -> int:
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
def _is_met(columns: Columns, world: World, solid: int, place: Vector) -> bool:
    """Return whether a ray along the direction meets a solid, as in ``geometry.rays.meet_faces``.

    Distances are measured upwards.
    """
    faces = world.faces
    enter, leave = 0.0, np.inf
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n_x, n_y, n_z = faces[face, 0], faces[face, 1], faces[face, 2]
        outside = n_x * place[0] + n_y * place[1] + n_z * place[2] - faces[face, 3]
        speed = n_x * columns.lean_x + n_y + n_z * columns.lean_z
        if speed < 0.0:
            enter = max(enter, -outside / speed)
        elif outside > 0.0:
            return False
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
        if enter > leave:
            return False
    return True
