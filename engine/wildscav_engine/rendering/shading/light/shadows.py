"""Which surfaces of a row are in a shadow: of the static world, or of what moves."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.geometry.rays import NOTHING_HIT
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.shading.light.ambient_light import place_of
from wildscav_engine.rendering.shading.light.columns import ShadowColumns, write_columns
from wildscav_engine.rendering.shading.light.moving_shadows import (
    LARGE,
    NOWHERE,
    Casters,
    is_shaded_by,
    write_squares,
)
from wildscav_engine.rendering.shading.light.sunlight import sun_shines
from wildscav_engine.rendering.shading.pixel_rows import AT_ONCE, Places, RowOfPixels, TextureScratch
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.solids import Solids

NONE, HIGHEST = np.float32(0.0), np.float32(np.inf)


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
            row, number, place = scratch.row[column], scratch.column[column], place_of(places, column)
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

    Args:
        record: As in ``ShadowColumns``, but all in one row.
        clear: As there.
        noted: The first notes of ``Casters``.
    """
    doubtful, places, large = 0, scratch.corner_above, noted[LARGE]
    for column in range(count):
        above = clear[nonnegative(record[nonnegative(places[column])])]
        is_below = np.int32(scratch.y[column] < above)
        # Always written, counted only if it is one: this avoids branches. What is overwritten has been read.
        places[nonnegative(doubtful)] = column
        doubtful += (is_below | noted[nonnegative(scratch.corner[column])] | large) != 0
    return doubtful
