"""The appearance of the ground: a colour and a smooth normal at each corner of the cells, and its grain."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.terrain import spread
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.rendering.palette import of_terrain
from wildscav_engine.rendering.shading.noise import (
    FOURS,
    between,
    corner_of,
    eased32,
    endless_noise,
    write_seen,
)
from wildscav_engine.rendering.shading.pixel_rows import (
    AT_ONCE,
    Channels,
    TextureScratch,
    TracedRow,
    Vectors,
    channels_in,
    vectors_in,
    write_footprints,
    write_places,
)
from wildscav_engine.rendering.tracing.frustum import nonnegative

SHORE = 3  # cells around water that show sand
# The grain of the ground: sizes in m of its details, and between the darkest and the brightest of them.
FINE, MEDIUM, COARSE = (0.11, 0.34), (0.45, 0.26), (2.3, 0.20)
NONE, HALF, ONE, ONE_AND_HALF = (np.float32(number) for number in (0.0, 0.5, 1.0, 1.5))
# Of the four corners of a cell: south-west, south-east, north-west, north-east.
Four = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]


class GroundAppearance(NamedTuple):
    """The appearance of R by C cells of ground, at their corners."""

    color: NDArray[np.float32]  # (R + 1, C + 1, 3) red, green, blue 0-255, unlit
    normal: NDArray[np.float32]  # (R + 1, C + 1, 3) unit vectors


def ground_appearance(world: World) -> GroundAppearance:
    """Return the appearance of a world's ground."""
    slope_north, slope_east = np.gradient(world.heights, CELL)
    up = 1.0 / np.sqrt(1.0 + slope_east * slope_east + slope_north * slope_north)
    normal = np.stack([-slope_east * up, up, -slope_north * up], axis=-1)
    dryness = np.empty(world.heights.shape)
    _write_dryness(dryness)
    over_water = world.heights - _water_nearby(world)
    color = of_terrain(over_water.ravel(), up.ravel(), dryness.ravel())
    return GroundAppearance(color.reshape(normal.shape).astype(np.float32), normal.astype(np.float32))


def _water_nearby(world: World) -> NDArray[np.float64]:
    """Return the height of the water near each cell corner, (R + 1, C + 1), -inf where there is none."""
    nearby = np.full(world.heights.shape, -np.inf)
    rows, columns = world.water.shape
    for row in range(2):
        for column in range(2):
            part = nearby[row : row + rows, column : column + columns]
            np.maximum(part, world.water, out=part)
    return spread(nearby, SHORE)


@kernel
def _write_dryness(dryness: NDArray[np.float64]) -> None:
    """Write the dryness of each cell corner, 0-1: soft patches with a little grain."""
    for row in range(dryness.shape[0]):
        for column in range(dryness.shape[1]):
            wide = endless_noise(column / 23.0, row / 23.0) + 0.6 * endless_noise(
                column / 9.0 + 40.0, row / 9.0
            )
            fine = endless_noise(column + 0.5, row + 80.5) - 0.5
            dryness[row, column] = min(1.0, max(0.0, 1.7 * (wide / 1.6 - 0.5) + 0.42 + 0.3 * fine))


def packed_ground(appearance: GroundAppearance) -> NDArray[np.float32]:
    """Return (R + 1, C + 1, 8) for kernels: of each corner its colour, its normal and two zeros.

    What belongs to a corner lies together in memory, because a pixel reads all of it.
    """
    packed = np.zeros((*appearance.color.shape[:2], 8), np.float32)
    packed[..., :3], packed[..., 3:6] = appearance.color, appearance.normal
    return packed


@inlined_kernel
def write_ground(
    world: World,
    ground: NDArray[np.float32],
    row: TracedRow,
    first: int,
    last: int,
    is_fast: bool,
    scratch: TextureScratch,
) -> None:
    """Write the colours without light, and the normals, of the ground from one column to before another."""
    view, pixels = row.camera, row.pixels
    for start in range(first, last, AT_ONCE):
        end = min(last, start + AT_ONCE)
        ways, normal = vectors_in(pixels.ways, start, end), vectors_in(pixels.normal, start, end)
        color, some = channels_in(pixels.color, start, end), row.line.distance[start:end]
        write_places(view, ways, some, scratch)
        _write_cells(world, end - start, scratch)
        _write_smooth(ground, scratch, color, normal)
        write_footprints(view, ways, some, normal, scratch)
        _write_grain(end - start, is_fast, scratch)
        for column in range(end - start):
            color.red[column] *= scratch.grain[column]
            color.green[column] *= scratch.grain[column]
            color.blue[column] *= scratch.grain[column]


@inlined_kernel
def _write_cells(world: World, count: int, scratch: TextureScratch) -> None:
    """Write the cells of places and the positions in them, 0-1; those beyond the map are at its edge."""
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
    ground: NDArray[np.float32], scratch: TextureScratch, color: Channels, normal: Vectors
) -> None:
    """Write colours without grain, and unit normals, which are smooth across the edges of triangles."""
    first, count = 0, color.red.shape[0]
    _write_shares(count, ground.shape[1], scratch)
    while first < count:
        last = _end_of_cell(scratch.corner, first, count)
        _blend_in_cell(ground, scratch, first, last, color, normal)
        first = last
    for column in range(count):
        x, y, z = normal.east[column], normal.up[column], normal.north[column]
        # Its length is nearly 1, so this is nearly the reciprocal of it, by Newton's method.
        scale = ONE_AND_HALF - HALF * (x * x + y * y + z * z)
        normal.east[column], normal.up[column], normal.north[column] = x * scale, y * scale, z * scale


@disjoint_kernel
def _write_shares(count: int, width: int, scratch: TextureScratch) -> None:
    """Write how much the corners of cells count at places, and number the cells."""
    for column in range(count):
        east, north = scratch.east[column], scratch.north[column]
        both = north * east
        scratch.pixel[column] = ONE - north - (east - both)  # the south-western one
        scratch.grain[column] = east - both
        scratch.seen[column] = north - both
        scratch.rise[column] = both
        scratch.corner[column] = scratch.row[column] * np.int32(width) + scratch.column[column]


@inlined_kernel
def _end_of_cell(cells: NDArray[np.int32], first: int, count: int) -> int:
    """Return where the places end, from one on, that are in the same cell."""
    last, cell = nonnegative(first + 1), cells[nonnegative(first)]
    while last + 4 <= count and (
        (cells[last] == cell)
        & (cells[last + 1] == cell)
        & (cells[last + 2] == cell)
        & (cells[last + 3] == cell)
    ):
        last += 4
    while last < count and cells[last] == cell:
        last += 1
    return last


@inlined_kernel
def _blend_in_cell(
    ground: NDArray[np.float32],
    scratch: TextureScratch,
    first: int,
    last: int,
    color: Channels,
    normal: Vectors,
) -> None:
    """Write what is between the corners of a cell at places in it, from one to before another."""
    row, column = nonnegative(scratch.row[first]), nonnegative(scratch.column[first])
    corners = (
        ground[row, column],
        ground[row, column + 1],
        ground[row + 1, column],
        ground[row + 1, column + 1],
    )
    shares = (
        scratch.pixel[first:last],
        scratch.grain[first:last],
        scratch.seen[first:last],
        scratch.rise[first:last],
    )
    _blend(corners, shares, 0, channels_in(color, first, last))
    _blend(corners, shares, 3, vectors_in(normal, first, last))


@disjoint_kernel
def _blend(corners: Four, shares: Four, part: int, blended: Channels | Vectors) -> None:
    """Write three of the numbers that corners have, from one part on, at places that have shares of each."""
    a, b, c, d = shares
    first, second, third = blended
    sw, se, nw, ne = corners
    sw0, se0, nw0, ne0 = sw[part], se[part], nw[part], ne[part]
    sw1, se1, nw1, ne1 = sw[part + 1], se[part + 1], nw[part + 1], ne[part + 1]
    sw2, se2, nw2, ne2 = sw[part + 2], se[part + 2], nw[part + 2], ne[part + 2]
    for at in range(first.shape[0]):
        first[at] = a[at] * sw0 + b[at] * se0 + c[at] * nw0 + d[at] * ne0
        second[at] = a[at] * sw1 + b[at] * se1 + c[at] * nw1 + d[at] * ne1
        third[at] = a[at] * sw2 + b[at] * se2 + c[at] * nw2 + d[at] * ne2


@inlined_kernel
def _write_grain(count: int, is_fast: bool, scratch: TextureScratch) -> None:
    """Write how bright the ground is for its grain."""
    for column in range(count):
        scratch.grain[column] = ONE
    if not is_fast:
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
