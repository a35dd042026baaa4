"""Light on a surface: from the sun and the sky, and what blocks it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.rays import (
    Ray,
    Step,
    leave_square,
    make_ray,
    meet_solid,
    meet_terrain,
)
from wildscav_engine.geometry.world import BLOCK, World
from wildscav_engine.rendering.palette import SKYLIGHT, SUNLIGHT
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, dot
from wildscav_engine.rendering.shading.columns import (
    BLOCKED,
    CLEAR,
    UNKNOWN,
    Columns,
    blocked_in,
    is_blocked,
)
from wildscav_engine.rendering.shading.pixel_rows import Normals
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION

SUN_COLOR = (float(SUNLIGHT[0]), float(SUNLIGHT[1]), float(SUNLIGHT[2]))
DIRECT = 0.90  # share of the palette's sunlight: less contrast, so that pictures show more of shaded places
SKY_COLOR = (float(SKYLIGHT[0]), float(SKYLIGHT[1]), float(SKYLIGHT[2]))
SIDE_LIGHT = (-0.10, -0.04)  # additional ambient light on surfaces that face east, and north
SHADOW_REACH = 80.0  # m, up to which an object casts a shadow


@inlined_kernel
def lit(base: Color, normal: Vector, sun: float, sky: float) -> Color:
    """Return the colour of a surface in daylight.

    Args:
        sun: Share of the sun's light that reaches it, 0-1.
        sky: Ambient light, 1 for a roof under the open sky.
    """
    direct = DIRECT * sun * max(0.0, dot(normal, SUN_DIRECTION))
    return (
        base[0] * (direct * SUN_COLOR[0] + sky * SKY_COLOR[0]),
        base[1] * (direct * SUN_COLOR[1] + sky * SKY_COLOR[1]),
        base[2] * (direct * SUN_COLOR[2] + sky * SKY_COLOR[2]),
    )


@disjoint_kernel
def write_skylight(normal: Normals, roofed: bool, ambient: NDArray[np.float32]) -> None:
    """Write the ambient light on surfaces.

    Under the open sky most of it comes from above, in a house from all walls. It is slightly brighter on one
    side, so that the edge between two walls is visible.
    """
    level, rise = (0.94, 0.06) if roofed else (0.90, 0.30)
    for column in range(ambient.shape[0]):
        east, up, north = float(normal.east[column]), float(normal.up[column]), float(normal.north[column])
        ambient[column] = level + rise * up + (SIDE_LIGHT[0] * east + SIDE_LIGHT[1] * north)


@kernel
def sun_is_clear(world: World, place: Vector) -> bool:
    """Return whether the static world leaves the line from a place to the sun free.

    It traverses the grid as ``rays.cast_ray`` does, but ends at any hit and relies on the ray's rising.
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
    if meet_terrain(world, ray, step, leave)[0] < np.inf:
        return True
    cell, height = step.row * world.water.shape[1] + step.column, ray.y + ray.dy * step.at
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        if world.solid_high[solid, 1] >= height and meet_solid(world, solid, ray, SHADOW_REACH)[0] < np.inf:
            return True
    return False


@inlined_kernel
def is_roofed(upwards: Columns, world: World, place: Vector) -> bool:
    """Return whether there is a floor or a roof above a place, given the columns of these."""
    return is_blocked(upwards, world, place) == BLOCKED


@inlined_kernel
def sun_shines(to_sun: Columns, world: World, row: int, number: int, place: Vector) -> bool:
    """Return the same as ``sun_is_clear`` for a place above the ground.

    Args:
        row: Of the column that the place belongs to, as of ``write_columns``.
        place: m.
    """
    if row < 0:
        return True
    found = blocked_in(to_sun, world, row, number, place)
    if found == UNKNOWN:
        return sun_is_clear(world, place)
    return found == CLEAR
