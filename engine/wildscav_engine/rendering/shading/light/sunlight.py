"""Light from the sun, and what blocks it."""

import numpy as np

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import (
    Ray,
    Step,
    intersect_solid,
    intersect_terrain,
    leave_square,
    make_ray,
)
from wildscav_engine.geometry.world import BLOCK, World
from wildscav_engine.rendering.palette import SKYLIGHT, SUNLIGHT
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.light.columns import CLEAR, UNKNOWN, ShadowColumns, blocked_in
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION

SUN_COLOR = (float(SUNLIGHT[0]), float(SUNLIGHT[1]), float(SUNLIGHT[2]))
DIRECT = 0.90  # share of the palette's sunlight: less contrast, so that pictures show more of shaded places
SKY_COLOR = (float(SKYLIGHT[0]), float(SKYLIGHT[1]), float(SKYLIGHT[2]))
SHADOW_REACH = 80.0  # m, up to which an object casts a shadow


@kernel
def sun_is_clear(world: World, place: Vector) -> bool:
    """Return whether the static world leaves the line from a place to the sun free.

    It traverses the grid as ``rays.raycast`` does, but ends at any hit and relies on the ray's rising.
    """
    x, y, z = place
    ray = make_ray(world, x, y, z, SUN_DIRECTION[0], SUN_DIRECTION[1], SUN_DIRECTION[2])
    rows, columns = world.water.shape
    step = Step(0.0, int(np.floor(ray.north)), int(np.floor(ray.east)))
    while step.at < SHADOW_REACH and 0 <= step.row < rows and 0 <= step.column < columns:
        row, column, height = step.row // BLOCK, step.column // BLOCK, y + SUN_DIRECTION[1] * step.at
        if height > world.block_top[row, column]:
            step = leave_square(ray, step, row * BLOCK, column * BLOCK, BLOCK, SHADOW_REACH)
            continue
        over = leave_square(ray, step, step.row, step.column, 1, SHADOW_REACH)
        if height <= world.cell_top[step.row, step.column] and _is_stopped(world, ray, step, over.at):
            return False
        step = over
    return True


@inlined_kernel
def _is_stopped(world: World, ray: Ray, step: Step, leave: float) -> bool:
    """Return whether the ray to the sun hits anything in a cell, which it leaves at ``leave``."""
    if intersect_terrain(world, ray, step, leave)[0] < np.inf:
        return True
    cell, height = step.row * world.water.shape[1] + step.column, ray.y + ray.dy * step.at
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        if (
            world.solid_high[solid, 1] >= height
            and intersect_solid(world, solid, ray, SHADOW_REACH)[0] < np.inf
        ):
            return True
    return False


@inlined_kernel
def sun_shines(to_sun: ShadowColumns, world: World, row: int, number: int, place: Vector) -> bool:
    """Return the same as ``sun_is_clear`` for a place above the ground, given its column."""
    if row < 0:
        return True
    found = blocked_in(to_sun, world, row, number, place)
    if found == UNKNOWN:
        return sun_is_clear(world, place)
    return found == CLEAR
