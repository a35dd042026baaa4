"""Light from the sun, and what keeps it off surfaces: the static world, or what moves."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.rays import (
    NOTHING_HIT,
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
from wildscav_engine.rendering.shading.light.columns import (
    CLEAR,
    UNKNOWN,
    ShadowColumns,
    blocked_in,
    write_columns,
)
from wildscav_engine.rendering.shading.light.moving_shadows import (
    LARGE,
    NOWHERE,
    Casters,
    is_shaded_by,
    write_squares,
)
from wildscav_engine.rendering.shading.pixel_rows import (
    AT_ONCE,
    Places,
    RowOfPixels,
    TextureScratch,
    place_at,
)
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.solids import Solids

SUN_COLOR = (float(SUNLIGHT[0]), float(SUNLIGHT[1]), float(SUNLIGHT[2]))
DIRECT = 0.90  # share of the palette's sunlight: less contrast, so that pictures show more of shaded places
SKY_COLOR = (float(SKYLIGHT[0]), float(SKYLIGHT[1]), float(SKYLIGHT[2]))
SHADOW_REACH = 80.0  # m, up to which an object casts a shadow
NONE, HIGHEST = np.float32(0.0), np.float32(np.inf)


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


@inlined_kernel
def write_shadows(
    to_sun: ShadowColumns,
    world: World,
    moving: Solids,
    casters: Casters,
    solids: NDArray[np.int32],
    scratch: TextureScratch,
    pixels: RowOfPixels,
) -> None:
    """Take the sun's light from the surfaces of a row that are in a shadow, given what its W rays hit."""
    own, direct = pixels.place, pixels.direct
    record = to_sun.record.reshape(to_sun.record.shape[0] * to_sun.record.shape[1])
    for start in range(0, direct.shape[0], AT_ONCE):
        end = min(direct.shape[0], start + AT_ONCE)
        places = Places(own.x[start:end], own.y[start:end], own.z[start:end])
        write_columns(to_sun, places, scratch.row[: end - start], scratch.column[: end - start])
        write_squares(casters, places, scratch.corner[: end - start])
        _look_up_lit(to_sun, solids[start:end], places.y, direct[start:end], scratch)
        count = _find_doubtful(record, to_sun.clear, casters.first, end - start, scratch)
        for item in range(count):
            column = nonnegative(scratch.corner_above[item])
            row, number, place = scratch.row[column], scratch.column[column], place_at(places, column)
            is_shaded = is_shaded_by(moving, casters, scratch.corner[column], place)
            if is_shaded or not sun_shines(to_sun, world, row, number, place):
                direct[start + column] = NONE


@disjoint_kernel
def _look_up_lit(
    to_sun: ShadowColumns,
    solids: NDArray[np.int32],
    heights: NDArray[np.float32],
    direct: NDArray[np.float32],
    scratch: TextureScratch,
) -> None:
    """Write where to look up what may shade pixels; those that do not face the sun find nothing there."""
    width = np.int32(to_sun.record.shape[1])
    for column in range(direct.shape[0]):
        row = scratch.row[column]
        is_lit = (solids[column] != NOTHING_HIT) & (direct[column] > NONE)
        scratch.y[column] = heights[column] if is_lit & (row >= 0) else HIGHEST
        scratch.corner[column] = scratch.corner[column] if is_lit else NOWHERE
        scratch.corner_above[column] = max(np.int32(0), row) * width + scratch.column[column]


@disjoint_kernel
def _find_doubtful(
    record: NDArray[np.int32],
    clear: NDArray[np.float32],
    noted: NDArray[np.int32],
    count: int,
    scratch: TextureScratch,
) -> int:
    """List the pixels that may be in a shadow, and return how many there are.

    ``record`` and ``clear`` are as in ``ShadowColumns``, but all in one row; ``noted`` is ``Casters.first``.
    """
    doubtful, places, large = 0, scratch.corner_above, noted[LARGE]
    for column in range(count):
        above = clear[nonnegative(record[nonnegative(places[column])])]
        is_below = np.int32(scratch.y[column] < above)
        # Always written, counted only if it is one: this avoids branches. What is overwritten has been read.
        places[nonnegative(doubtful)] = column
        doubtful += (is_below | noted[nonnegative(scratch.corner[column])] | large) != 0
    return doubtful
