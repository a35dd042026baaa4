"""Fans of rays: rays of one azimuth that start at one point and differ only in slope. LIDAR casts these.

The rays of a fan pass over the same cells, so they traverse the grid together. Of two rays, the steeper one
is higher everywhere. So in each cell the rays are tested from the lowest upwards, until one passes above the
cell.

Distances are horizontal, in m. The slope of a ray is its rise in m per horizontal m.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.rays import Ray, Step, leave_square, meet_faces, meet_terrain
from wildscav_engine.geometry.world import BLOCK, World

SLACK = 1e-9  # m by which the box around a solid is enlarged, so that rounding lets no ray slip past it


class RayFans(NamedTuple):
    """A fans of C rays each."""

    slopes: NDArray[np.float64]  # (C,) of the rays of every fan, descending
    reach: NDArray[np.float64]  # (A, C) m, horizontal distance to the first hit of each ray
    seen_by: NDArray[np.int64]  # (S,) the last fan that met each solid of the world, or -1


@kernel
def cast_ray_fan(world: World, fans: RayFans, fan: int, ray: Ray) -> None:
    """Shorten the rays of a fan to where they meet the static world, as ``cast_ray`` does for each.

    Args:
        world: The static world.
        fans: The fans; their reaches are read and written.
        fan: Index of the fan.
        ray: A level ray of its azimuth.
    """
    rows, columns = world.water.shape
    far = 0.0
    for channel in range(fans.slopes.shape[0]):
        far = max(far, fans.reach[fan, channel])
    step = Step(0.0, int(np.floor(ray.north)), int(np.floor(ray.east)))
    lowest = fans.slopes.shape[0] - 1
    while step.at < far and 0 <= step.row < rows and 0 <= step.column < columns:
        lowest = _lowest_open(fans, fan, lowest, step.at)
        if lowest < 0:
            return
        block_row, block_column = step.row // BLOCK, step.column // BLOCK
        over = leave_square(ray, step, block_row * BLOCK, block_column * BLOCK, BLOCK, far)
        if _least_height(fans, lowest, ray, step.at, over.at) > world.block_top[block_row, block_column]:
            step = over
        else:
            step, lowest = _cross_block(world, fans, fan, ray, step, lowest, far)


@kernel
def meet_solid_with_ray_fan(
    solids: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]],
    solid: int,
    fans: RayFans,
    fan: int,
    ray: Ray,
    lowest: int,
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
    enter, leave = _cross_slab(ray.x, ray.dx, low[solid, 0], high[solid, 0], enter, leave)
    enter, leave = _cross_slab(ray.z, ray.dz, low[solid, 2], high[solid, 2], enter, leave)
    if enter > leave:
        return
    for channel in range(lowest, -1, -1):
        slope, nearest = fans.slopes[channel], fans.reach[fan, channel]
        first, last = ray.y + slope * enter, ray.y + slope * leave
        if min(first, last) > high[solid, 1] + SLACK:
            return
        if nearest > enter and max(first, last) >= low[solid, 1] - SLACK:
            direction = _rising(ray, slope)
            distance, _ = meet_faces(faces, start[solid], start[solid + 1], direction, nearest)
            fans.reach[fan, channel] = min(nearest, distance)


@kernel
def _cross_slab(
    start: float, direction: float, low: float, high: float, enter: float, leave: float
) -> tuple[float, float]:
    """Return the part of a ray within a slab, limited to ``enter`` and ``leave``; ends first if empty."""
    low, high = low - SLACK, high + SLACK
    if direction == 0.0:
        return (enter, leave) if low <= start <= high else (np.inf, 0.0)
    first, last = (low - start) / direction, (high - start) / direction
    return max(enter, min(first, last)), min(leave, max(first, last))


@kernel
def _lowest_open(fans: RayFans, fan: int, lowest: int, at: float) -> int:
    """Return the lowest ray at or above ``lowest`` that has not ended yet; -1 if all have."""
    while lowest >= 0 and fans.reach[fan, lowest] <= at:
        lowest -= 1
    return lowest


@kernel
def _least_height(fans: RayFans, channel: int, ray: Ray, start: float, end: float) -> float:
    slope = fans.slopes[channel]
    return float(min(ray.y + slope * start, ray.y + slope * end))


@kernel
def _rising(ray: Ray, slope: float) -> Ray:
    """Return the ray of a slope; its distances are horizontal, too."""
    return Ray(
        ray.x, ray.y, ray.z, ray.dx, slope, ray.dz,
        ray.east, ray.north, ray.d_east, ray.d_north, ray.per_east, ray.per_north,
    )  # fmt: skip


@kernel
def _cross_block(
    world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int, far: float
) -> tuple[Step, int]:
    """Move a fan through the cells of a block; return where it leaves and its lowest ray not ended yet."""
    rows, columns = world.water.shape
    block_row, block_column = step.row // BLOCK, step.column // BLOCK
    while (
        step.at < far
        and step.row // BLOCK == block_row
        and step.column // BLOCK == block_column
        and 0 <= step.row < rows
        and 0 <= step.column < columns
    ):
        over = leave_square(ray, step, step.row, step.column, 1, far)
        if _least_height(fans, lowest, ray, step.at, over.at) <= world.cell_top[step.row, step.column]:
            _meet_ground(world, fans, fan, ray, step, lowest, over.at)
            _meet_solids(world, fans, fan, ray, step, lowest)
            lowest = _lowest_open(fans, fan, lowest, over.at)
            if lowest < 0:
                break
        step = over
    return step, lowest


@kernel
def _meet_ground(
    world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int, leave: float
) -> None:
    """Shorten the rays of a fan to where they hit the ground of a cell."""
    row, column = step.row, step.column
    south = max(world.heights[row, column], world.heights[row, column + 1])
    north = max(world.heights[row + 1, column], world.heights[row + 1, column + 1])
    for channel in range(lowest, -1, -1):
        if _least_height(fans, channel, ray, step.at, leave) > max(south, north):
            return
        if fans.reach[fan, channel] > step.at:
            distance, _ = meet_terrain(world, _rising(ray, fans.slopes[channel]), step, leave)
            fans.reach[fan, channel] = min(fans.reach[fan, channel], distance)


@kernel
def _meet_solids(world: World, fans: RayFans, fan: int, ray: Ray, step: Step, lowest: int) -> None:
    """Shorten the rays of a fan to where they meet the solids of a cell; each solid is tested only once."""
    solids = (world.solid_low, world.solid_high, world.solid_start, world.faces)
    cell = step.row * world.water.shape[1] + step.column
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        if fans.seen_by[solid] != fan:
            fans.seen_by[solid] = fan
            meet_solid_with_ray_fan(solids, solid, fans, fan, ray, lowest)
