"""Fans of rays: rays of one azimuth that start at one point and differ only in slope. LIDAR casts these.

The rays of a fan pass over the same cells, so they traverse the grid together. Of two rays, the steeper one
is higher everywhere. So in each cell the rays are tested from the lowest upwards, until one passes above the
cell.

Distances are horizontal, in m. The slope of a ray is its rise in m per horizontal m.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.rays import Ray, Step, leave_square
from wildscav_engine.geometry.world import BLOCK, CELL, World

SLACK = 1e-9  # m by which the box around a solid is enlarged, so that rounding lets no ray slip past it
Solids = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]


class RayFans(NamedTuple):
    """A fans of C rays each."""

    slopes: NDArray[np.float64]  # (C,) of the rays of every fan, descending
    reach: NDArray[np.float64]  # (A, C) m, horizontal distance to the first hit of each ray
    seen_by: NDArray[np.int64]  # (S,) the last fan that met each solid of the world, or -1


@inlined_kernel
def cast_ray_fan(world: World, fans: RayFans, fan: int, ray: Ray) -> None:
    """Shorten the rays of a fan to where they meet the static world, as ``cast_ray`` does for each.

    Args:
        world: The static world.
        fans: The fans; their reaches are read and written.
        fan: Index of the fan.
        ray: A level ray of its azimuth.
    """
    rows, columns = world.water.shape
    reach, far = fans.reach[fan], 0.0
    for channel in range(reach.shape[0]):
        far = max(far, reach[channel])
    step = Step(0.0, int(np.floor(ray.north)), int(np.floor(ray.east)))
    lowest = reach.shape[0] - 1
    while step.at < far and 0 <= step.row < rows and 0 <= step.column < columns:
        lowest = _lowest_open(reach, lowest, step.at)
        if lowest < 0:
            return
        block_row, block_column = step.row // BLOCK, step.column // BLOCK
        over = leave_square(ray, step, block_row * BLOCK, block_column * BLOCK, BLOCK, far)
        least = _least_height(ray, fans.slopes[lowest], step.at, over.at)
        if least > world.block_top[block_row, block_column]:
            step = over
        else:
            step, lowest = _cross_block(world, fans, fan, ray, step, lowest, far)


@inlined_kernel
def _cross_block(
    world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int, far: float
) -> tuple[Step, int]:
    """Move a fan through the cells of a block; return where it leaves and its lowest ray not ended yet."""
    rows, columns = world.water.shape
    first_row, first_column = step.row // BLOCK * BLOCK, step.column // BLOCK * BLOCK
    last_row, last_column = min(rows, first_row + BLOCK), min(columns, first_column + BLOCK)
    at, row, column = step
    slope = fans.slopes[lowest]
    while at < far and first_row <= row < last_row and first_column <= column < last_column:
        # The same as ``leave_square`` of one cell.
        out_east = (column + (ray.d_east > 0.0) - ray.east) * ray.per_east if ray.d_east != 0.0 else np.inf
        out_north = (row + (ray.d_north > 0.0) - ray.north) * ray.per_north if ray.d_north != 0.0 else np.inf
        leave = min(out_east, out_north, far)
        if _least_height(ray, slope, at, leave) <= world.cell_top[row, column]:
            over = Step(at, row, column)
            _meet_ground(world, fans, fan, ray, over, lowest, leave)
            _meet_solids(world, fans, fan, ray, over, lowest)
            lowest = _lowest_open(fans.reach[fan], lowest, leave)
            if lowest < 0:
                break
            slope = fans.slopes[lowest]
        goes_east = out_east <= out_north
        column += (1 if ray.d_east > 0.0 else -1) if goes_east else 0
        row += 0 if goes_east else (1 if ray.d_north > 0.0 else -1)
        at = leave
    return Step(at, row, column), lowest


@inlined_kernel
def _lowest_open(reach: NDArray[np.float64], lowest: int, at: float) -> int:
    """Return the lowest ray at or above ``lowest`` that has not ended yet; -1 if all have."""
    while lowest >= 0 and reach[lowest] <= at:
        lowest -= 1
    return lowest


@inlined_kernel
def _least_height(ray: Ray, slope: float, start: float, end: float) -> float:
    """Return the least height in m of a ray of a slope between two distances."""
    return float(min(ray.y + slope * start, ray.y + slope * end))


class _Part(NamedTuple):
    """The part of a fan over one triangle of a cell."""

    start: float  # m, where it enters
    end: float  # m, where it leaves
    above: float  # m, height of the fan's start over the triangle's plane
    rise: float  # of the plane, m per m along the fan


@inlined_kernel
def _part_over(world: World, ray: Ray, step: Step, start: float, end: float) -> _Part:
    """Return the part of a fan over the triangle that it crosses between two distances."""
    h00, h01 = world.heights[step.row, step.column], world.heights[step.row, step.column + 1]
    h10, h11 = world.heights[step.row + 1, step.column], world.heights[step.row + 1, step.column + 1]
    east, north = ray.east - step.column, ray.north - step.row
    south_east = east - north + (ray.d_east - ray.d_north) * (start + end) * 0.5 >= 0.0
    slope_east = h01 - h00 if south_east else h11 - h10
    slope_north = h11 - h01 if south_east else h10 - h00
    above = ray.y - (h00 + slope_east * east + slope_north * north)
    return _Part(start, end, above, slope_east * ray.d_east + slope_north * ray.d_north)


@inlined_kernel
def _distance_to(part: _Part, slope: float) -> float:
    """Return where the ray of a slope meets the ground of a part; inf if it does not."""
    steepness = slope - part.rise
    above_start, above_end = part.above + steepness * part.start, part.above + steepness * part.end
    if above_start <= 0.0:
        return part.start
    if above_end <= 0.0:
        along = part.start + (part.end - part.start) * above_start / (above_start - above_end)
        return min(part.end, along)
    return np.inf


@inlined_kernel
def _meet_ground(
    world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int, leave: float
) -> None:
    """Shorten the rays of a fan to where they hit the ground of a cell, by the same sums as ``meet_terrain``.

    Only the slopes of the rays differ, so all else is computed once.
    """
    row, column, at = step.row, step.column, step.at
    south = max(world.heights[row, column], world.heights[row, column + 1])
    north = max(world.heights[row + 1, column], world.heights[row + 1, column + 1])
    top, reach = max(south, north), fans.reach[fan]
    if _least_height(ray, fans.slopes[lowest], at, leave) > top:
        return
    # The diagonal is where east and north are equal.
    gap, d_gap = (ray.east - column) - (ray.north - row), ray.d_east - ray.d_north
    middle = leave
    if d_gap != 0.0 and at < -gap / d_gap < leave:
        middle = -gap / d_gap
    near = _part_over(world, ray, step, at, middle)
    beyond = _part_over(world, ray, step, middle, leave)
    for channel in range(lowest, -1, -1):
        slope = fans.slopes[channel]
        if _least_height(ray, slope, at, leave) > top:
            return
        if reach[channel] > at:
            distance = _distance_to(near, slope)
            if distance == np.inf and middle != leave:
                distance = _distance_to(beyond, slope)
            reach[channel] = min(reach[channel], distance)


@inlined_kernel
def _meet_solids(world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int) -> None:
    """Shorten the rays of a fan to where they meet the solids of a cell; each solid is tested only once."""
    solids = (world.solid_low, world.solid_high, world.solid_start, world.faces)
    cell = step.row * world.water.shape[1] + step.column
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        if fans.seen_by[solid] != fan:
            fans.seen_by[solid] = fan
            meet_solid_with_ray_fan(solids, solid, fans, fan, ray, lowest)


@inlined_kernel
def meet_solid_with_ray_fan(
    solids: Solids, solid: int, fans: RayFans, fan: int, ray: Ray, lowest: int
) -> None:
    """Shorten the rays of a fan to where they meet a solid.

    Args:
        solids: The arrays ``low``, ``high``, ``face_start`` and ``faces`` of some solids.
        solid: Index of the solid.
        fans: The fans; their reaches are read and written.
        fan: Index of the fan.
        ray: A level ray of its azimuth.
        lowest: Index of the lowest ray to test; the rays after it are left unchanged.
    """
    low, high, start, faces = solids
    enter, leave = 0.0, np.inf
    enter, leave = _cross_slab(ray.x, ray.per_east, low[solid, 0], high[solid, 0], enter, leave)
    enter, leave = _cross_slab(ray.z, ray.per_north, low[solid, 2], high[solid, 2], enter, leave)
    if enter > leave:
        return
    bottom, top, reach = low[solid, 1] - SLACK, high[solid, 1] + SLACK, fans.reach[fan]
    for channel in range(lowest, -1, -1):
        slope = fans.slopes[channel]
        first, last = ray.y + slope * enter, ray.y + slope * leave
        if min(first, last) > top:
            return
        if reach[channel] > enter and max(first, last) >= bottom:
            distance = _distance_to_faces(faces, start[solid], start[solid + 1], ray, slope, reach[channel])
            reach[channel] = min(reach[channel], distance)


@inlined_kernel
def _cross_slab(
    start: float, per_cell: float, low: float, high: float, enter: float, leave: float
) -> tuple[float, float]:
    """Return the part of a ray within a slab, limited to ``enter`` and ``leave``; ends first if empty.

    ``per_cell`` is the ray's length for a cell across the slab, infinite for a ray along the slab.
    """
    low, high = low - SLACK, high + SLACK
    if abs(per_cell) == np.inf:
        return (enter, leave) if low <= start <= high else (np.inf, 0.0)
    per_metre = per_cell * (1.0 / CELL)
    first, last = (low - start) * per_metre, (high - start) * per_metre
    return max(enter, min(first, last)), min(leave, max(first, last))


@inlined_kernel
def _distance_to_faces(
    faces: NDArray[np.float64], first: int, last: int, ray: Ray, slope: float, nearest: float
) -> float:
    """Return where the ray of a slope enters the solid with some faces, as ``meet_faces`` does."""
    enter, leave = 0.0, nearest
    for face in range(first, last):
        n_x, n_y, n_z = faces[face, 0], faces[face, 1], faces[face, 2]
        outside = n_x * ray.x + n_y * ray.y + n_z * ray.z - faces[face, 3]
        speed = n_x * ray.dx + n_y * slope + n_z * ray.dz
        if speed < 0.0:
            enter = max(enter, -outside / speed)
        elif outside > 0.0:
            return np.inf
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
        if enter > leave:
            return np.inf
    return enter
