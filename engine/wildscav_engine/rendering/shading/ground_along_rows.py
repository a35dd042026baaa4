"""The appearance of the ground along a row of pixels: that of ``ground``, in loops that are vectorized."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.rendering.shading.details_along_rows import (
    write_footprints,
    write_places,
    write_seen,
)
from wildscav_engine.rendering.shading.ground import COARSE, FINE, MEDIUM, blend, corners_of
from wildscav_engine.rendering.shading.noise import FOURS, between, corner_of, eased32
from wildscav_engine.rendering.shading.pixel_rays import View, Ways
from wildscav_engine.rendering.shading.pixel_rows import Channels, Normals, RowOfPixels
from wildscav_engine.rendering.shading.texture_scratch import AT_ONCE, TextureScratch
from wildscav_engine.rendering.tracing.frustum import nonnegative

NONE, HALF, ONE, ONE_AND_HALF = (np.float32(number) for number in (0.0, 0.5, 1.0, 1.5))


@inlined_kernel
def write_ground(
    world: World,
    ground: NDArray[np.float32],
    view: View,
    distances: NDArray[np.float32],
    first: int,
    last: int,
    scratch: TextureScratch,
    pixels: RowOfPixels,
) -> None:
    """Write the colours without light, and the normals, of the ground from one column to before another.

    Args:
        distances: (W,) m along the rays of the row.
    """
    for start in range(first, last, AT_ONCE):
        end = min(last, start + AT_ONCE)
        own, color, normal = pixels.ways, pixels.color, pixels.normal
        ways = Ways(own.east[start:end], own.up[start:end], own.north[start:end])
        red, green, blue = color.red[start:end], color.green[start:end], color.blue[start:end]
        east, up, north = normal.east[start:end], normal.up[start:end], normal.north[start:end]
        some = distances[start:end]
        write_places(view, ways, some, scratch)
        _write_cells(world, end - start, scratch)
        _write_smooth(ground, scratch, Channels(red, green, blue), Normals(east, up, north))
        write_footprints(view, ways, some, Normals(east, up, north), scratch)
        _write_grain(end - start, scratch)
        for column in range(end - start):
            red[column] *= scratch.grain[column]
            green[column] *= scratch.grain[column]
            blue[column] *= scratch.grain[column]


@inlined_kernel
def _write_cells(world: World, count: int, scratch: TextureScratch) -> None:
    """Write the cells of places and the positions in them, as ``ground.cell_at`` does."""
    rows, columns = world.water.shape
    west, south, per_m = np.float32(world.corner[0]), np.float32(world.corner[1]), np.float32(1.0 / CELL)
    last_row, last_column = np.float32(rows - 1), np.float32(columns - 1)
    for column in range(count):
        along = (scratch.x[column] - west) * per_m
        cell = min(last_column, max(NONE, np.floor(along)))
        scratch.column[column] = np.int32(cell)
        scratch.east[column] = min(ONE, max(NONE, along - cell))
    for column in range(count):
        along = (scratch.z[column] - south) * per_m
        cell = min(last_row, max(NONE, np.floor(along)))
        scratch.row[column] = np.int32(cell)
        scratch.north[column] = min(ONE, max(NONE, along - cell))


@inlined_kernel
def _write_smooth(
    ground: NDArray[np.float32], scratch: TextureScratch, color: Channels, normal: Normals
) -> None:
    """Write colours without grain, and unit normals, which are smooth across the edges of triangles."""
    for column in range(color.red.shape[0]):
        row, first = nonnegative(scratch.row[column]), nonnegative(scratch.column[column])
        east, north = scratch.east[column], scratch.north[column]
        corners = corners_of(ground, row, first, north, east)
        color.red[column] = blend(corners, 0)
        color.green[column] = blend(corners, 1)
        color.blue[column] = blend(corners, 2)
        normal.east[column] = blend(corners, 3)
        normal.up[column] = blend(corners, 4)
        normal.north[column] = blend(corners, 5)
    for column in range(color.red.shape[0]):
        x, y, z = normal.east[column], normal.up[column], normal.north[column]
        # Its length is nearly 1, so this is nearly the reciprocal of it, by Newton's method.
        scale = ONE_AND_HALF - HALF * (x * x + y * y + z * z)
        normal.east[column], normal.up[column], normal.north[column] = x * scale, y * scale, z * scale


@inlined_kernel
def _write_grain(count: int, scratch: TextureScratch) -> None:
    """Write how bright the ground is for its grain."""
    for column in range(count):
        scratch.grain[column] = ONE
    _add_grain(FINE, count, scratch)
    _add_grain(MEDIUM, count, scratch)
    _add_grain(COARSE, count, scratch)


@inlined_kernel
def _add_grain(details: tuple[float, float], count: int, scratch: TextureScratch) -> None:
    """Add the grain of one size, unless no pixel shows it."""
    (size, strength), seen = details, scratch.seen
    if not write_seen(np.float32(size), np.float32(strength), count, scratch.pixel, seen):
        return
    _place_in_noise(np.float32(1.0 / size), count, scratch)
    for column in range(count):
        scratch.corner[column] = FOURS[nonnegative(scratch.corner[column])]
    for column in range(count):
        bright = between(scratch.corner[column], scratch.east[column], scratch.north[column])
        scratch.grain[column] += seen[column] * (bright - HALF)


@inlined_kernel
def _place_in_noise(per_m: np.float32, count: int, scratch: TextureScratch) -> None:
    """Write where places are in the noise, of which so much is in a metre; see ``noise.noise``."""
    for column in range(count):
        x, z = scratch.x[column] * per_m, scratch.z[column] * per_m
        west, south = np.floor(x), np.floor(z)
        scratch.east[column] = eased32(x - west)
        scratch.north[column] = eased32(z - south)
        scratch.corner[column] = corner_of(int(np.int32(west)), int(np.int32(south)))
