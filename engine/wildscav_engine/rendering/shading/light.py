"""Light on a surface: from the sun and the sky, and what blocks it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.rays import (
    Ray,
    Step,
    leave_square,
    make_ray,
    meet_solid,
    meet_terrain,
)
from wildscav_engine.geometry.world import BLOCK, Kind, World, cell_of
from wildscav_engine.rendering.palette import SKYLIGHT, SUNLIGHT
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, dot
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.rendering.tracing.solids import Solids

SUN_COLOR = (float(SUNLIGHT[0]), float(SUNLIGHT[1]), float(SUNLIGHT[2]))
DIRECT = 0.90  # share of the palette's sunlight: less contrast, so that pictures show more of shaded places
SKY_COLOR = (float(SKYLIGHT[0]), float(SKYLIGHT[1]), float(SKYLIGHT[2]))
SIDE_LIGHT = (-0.10, -0.04)  # additional ambient light on surfaces that face east, and north
SHADOW_REACH = 80.0  # m, up to which an object casts a shadow
MOVING_REACH = 40.0  # m from the eye, up to which moving solids cast shadows
FLOOR, ROOF = int(Kind.FLOOR), int(Kind.ROOF)
LIFT = 0.004  # m off the surface, where a shadow ray starts


@inlined_kernel
def lit(base: Color, normal: Vector, sun: float, sky: float) -> Color:
    """Return the colour of a surface in daylight.

    Args:
        base: Its own colour.
        normal: Its unit normal.
        sun: Share of the sun's light that reaches it, 0-1.
        sky: Ambient light, 1 for a roof under the open sky.
    """
    direct = DIRECT * sun * max(0.0, dot(normal, SUN_DIRECTION))
    return (
        base[0] * (direct * SUN_COLOR[0] + sky * SKY_COLOR[0]),
        base[1] * (direct * SUN_COLOR[1] + sky * SKY_COLOR[1]),
        base[2] * (direct * SUN_COLOR[2] + sky * SKY_COLOR[2]),
    )


@inlined_kernel
def skylight(normal: Vector, roofed: bool) -> float:
    """Return the ambient light on a surface.

    Under the open sky most of it comes from above, in a house from all walls. It is slightly brighter on one
    side, so that the edge between two walls is visible.
    """
    aside = SIDE_LIGHT[0] * normal[0] + SIDE_LIGHT[1] * normal[2]
    if roofed:
        return 0.94 + 0.06 * normal[1] + aside
    return 0.90 + 0.30 * normal[1] + aside


@inlined_kernel
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
def is_roofed(world: World, place: Vector) -> bool:
    """Return whether there is a floor or a roof above a place."""
    x, y, z = place
    rows, columns = world.water.shape
    cell = cell_of(world.corner[1], z, rows) * columns + cell_of(world.corner[0], x, columns)
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        kind = world.solid_kind[solid]
        if (kind != FLOOR and kind != ROOF) or not _is_below(world, solid, place):
            continue
        ray = make_ray(world, x, y, z, 0.0, 1.0, 0.0)
        if meet_solid(world, solid, ray, np.inf)[0] < np.inf:
            return True
    return False


@inlined_kernel
def _is_below(world: World, solid: int, place: Vector) -> bool:
    """Return whether a place is in or below the box around a solid."""
    low, high = world.solid_low, world.solid_high
    return bool(
        place[1] <= high[solid, 1]
        and low[solid, 0] <= place[0] <= high[solid, 0]
        and low[solid, 2] <= place[2] <= high[solid, 2]
    )


@kernel
def find_shadow_casters(moving: Solids, eye: NDArray[np.float64], casters: NDArray[np.int64]) -> int:
    """Write the moving solids that are near enough to an eye to cast shadows; return how many.

    Args:
        moving: S solids.
        eye: (3,) m.
        casters: (S,) indices of solids, written.
    """
    count = 0
    for solid in range(moving.kind.shape[0]):
        dx, dz = moving.low[solid, 0] - eye[0], moving.low[solid, 2] - eye[2]
        if dx * dx + dz * dz < MOVING_REACH * MOVING_REACH:
            casters[count] = solid
            count += 1
    return count


@inlined_kernel
def is_shaded_by(moving: Solids, casters: NDArray[np.int64], count: int, place: Vector) -> bool:
    """Return whether one of the first ``count`` casters stands between a place and the sun."""
    for item in range(count):
        solid = casters[item]
        above = moving.high[solid, 1] - place[1]
        if above < 0.0:
            continue
        # The horizontal position of the ray to the sun at the height of the solid's top.
        along = above / SUN_DIRECTION[1]
        x, z = place[0] + SUN_DIRECTION[0] * along, place[2] + SUN_DIRECTION[2] * along
        if max(x, place[0]) < moving.low[solid, 0] or min(x, place[0]) > moving.high[solid, 0]:
            continue
        if max(z, place[2]) < moving.low[solid, 2] or min(z, place[2]) > moving.high[solid, 2]:
            continue
        if _blocks_sun(moving, solid, place):
            return True
    return False


@inlined_kernel
def _blocks_sun(moving: Solids, solid: int, place: Vector) -> bool:
    """Return whether a solid blocks the ray to the sun, clipped as in ``geometry.rays.meet_solid``."""
    enter, leave = 0.0, np.inf
    for face in range(moving.face_start[solid], moving.face_start[solid + 1]):
        normal = (moving.faces[face, 0], moving.faces[face, 1], moving.faces[face, 2])
        outside, speed = dot(normal, place) - moving.faces[face, 3], dot(normal, SUN_DIRECTION)
        if speed < 0.0:
            enter = max(enter, -outside / speed)
        elif outside > 0.0:
            return False
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
    return enter < leave
