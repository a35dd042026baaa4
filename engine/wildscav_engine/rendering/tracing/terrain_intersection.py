"""Intersecting the rays of an image with the terrain and the water of a block of cells.

All corners of the cells are projected onto the image first. Then each cell is intersected with the rays of
the few pixels that it may cover.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.tracing.coarse_projection import (
    NEAR,
    ROUNDED,
    SLACK,
    Float32Camera,
    curved_up_to,
)
from wildscav_engine.rendering.tracing.frustum import (
    Camera,
    Rectangle,
    empty_outline,
    extended,
    is_outside_view,
    lowest_bit,
    nonnegative,
    pixels_of,
    to_camera_axes,
)
from wildscav_engine.rendering.tracing.hit_buffer import (
    FEW,
    HitBuffer,
    code_of_triangle,
    code_of_water,
    nearer_of,
    reaches_beyond,
    start_in_row,
    whole_vectors,
)
from wildscav_engine.rendering.tracing.scene_arrays import COLUMNS, CORNERS, ROWS, SQUARE, Blocks

OUT_OF_REACH = 1e300  # m, so high above a plane that no ray meets it before its hit
OVERLAP = 1e-8  # m that a triangle reaches beyond its edges, so that no ray slips between two
# The projection of a block holds the positions of its cells' corners, and of the cells, on an image; row
# after row, CORNERS per row. These are the offsets of its parts: m east and north of the first corner; a bit
# for each cell of a row; m ahead of the camera and to its right; columns to the right of the middle of the
# image; rows above its level, at most and at least; first and last columns and rows of a cell's pixels; the
# cell's bit if it may be visible, else 0.
EAST, NORTH, BIT, AHEAD, RIGHT, ACROSS, HIGH, LOW, FIRST, LAST, TOP, BOTTOM, SHOWN = (
    SQUARE * row for row in range(13)
)


def allocate_projection() -> NDArray[np.float32]:
    """Return an array for the projection of a block, with what is the same for all blocks."""
    projection = np.zeros(13 * SQUARE, np.float32)
    row, column = np.minimum(np.arange(SQUARE) // CORNERS, BLOCK), np.arange(SQUARE) % CORNERS
    projection[EAST:NORTH], projection[NORTH:BIT], projection[BIT:AHEAD] = (
        column * CELL,
        row * CELL,
        1 << column,
    )
    return projection


class Square(NamedTuple):
    """A block of cells relative to a camera."""

    block: int
    row: int  # of its south-western cell
    column: int
    east: float  # m from the camera to its south-western corner
    north: float


@inlined_kernel
def height_in(blocks: Blocks, row: int, column: int, camera: Camera) -> tuple[float, int]:
    """Return the height in m of the ground under a camera, and the triangle of its cell there, 0 or 1."""
    block = row // BLOCK * ((blocks.extent[COLUMNS] + BLOCK - 1) // BLOCK) + column // BLOCK
    at = row % BLOCK * CORNERS + column % BLOCK
    heights = blocks.heights[block]
    h00, h01, h10, h11 = heights[at], heights[at + 1], heights[at + CORNERS], heights[at + CORNERS + 1]
    east = (camera.x - blocks.edges[0]) / CELL - column
    north = (camera.z - blocks.edges[1]) / CELL - row
    if east >= north:
        return h00 + (h01 - h00) * east + (h11 - h01) * north, 0
    return h00 + (h11 - h10) * east + (h10 - h00) * north, 1


@kernel
def trace_terrain(
    blocks: Blocks,
    square: Square,
    is_near: bool,
    camera: Camera,
    camera32: Float32Camera,
    projection: NDArray[np.float32],
    buffer: HitBuffer,
) -> None:
    """Intersect the rays of an image with the terrain of a block, which may have cells near the camera."""
    _project_corners(
        blocks.rises[square.block], square, blocks.lowest[square.block] - camera.y, camera32, projection
    )
    _find_pixels_of_cells(camera32, projection)
    if is_near:
        _show_near_cells(camera32, projection)
    shown = _shown_cells(blocks.extent[ROWS] - square.row, blocks.extent[COLUMNS] - square.column, projection)
    while shown != 0:
        number = lowest_bit(shown)
        shown &= shown - 1
        cell = number // BLOCK * CORNERS + number % BLOCK
        nearest = float(_least_of(projection, AHEAD + cell))
        if is_near and nearest <= NEAR:
            pixels = _pixels_of_near_cell(blocks, square, camera, cell)
        else:
            pixels = Rectangle(
                int(projection[FIRST + cell]),
                int(projection[LAST + cell]) + 1,
                int(projection[TOP + cell]),
                int(projection[BOTTOM + cell]) + 1,
            )
        # The distance along a ray is never less than the depth ahead. In larger images, this saves no time.
        reach = nearest * (1.0 - ROUNDED) - SLACK
        if pixels.left < pixels.right and (
            buffer.met.shape[0] > FEW or reaches_beyond(buffer, pixels, reach)
        ):
            _trace_cell(blocks, square, camera, cell, pixels, buffer)


@inlined_kernel
def _project_corners(
    rises: NDArray[np.float32],
    square: Square,
    ground: float,
    camera: Float32Camera,
    projection: NDArray[np.float32],
) -> None:
    """Project the corners of a block onto the image, in a loop that vectorizes.

    ``rises`` is (96,) m, each corner above the lowest; ``ground`` is in m, the lowest above the camera.
    """
    sin_yaw, cos_yaw = camera.sin_yaw, camera.cos_yaw
    sin_pitch, cos_pitch = camera.sin_pitch, camera.cos_pitch
    east, north, bottom = np.float32(square.east), np.float32(square.north), np.float32(ground)
    one, limit = np.float32(1.0), curved_up_to(camera)
    for at in range(SQUARE):
        x, z, up = east + projection[EAST + at], north + projection[NORTH + at], bottom + rises[at]
        level, right = sin_yaw * x + cos_yaw * z, cos_yaw * x - sin_yaw * z
        ahead = cos_pitch * level - sin_pitch * up
        inverse = one / ahead
        projection[AHEAD + at], projection[RIGHT + at] = ahead, right
        across = right * inverse
        projection[ACROSS + at] = across * (camera.scale + camera.curve * min(across * across, limit))
        above = (cos_pitch * up + sin_pitch * level) * inverse
        rows, give = above * camera.scale_up, abs(above) * camera.spread
        projection[HIGH + at], projection[LOW + at] = rows + give, rows - give


@inlined_kernel
def _find_pixels_of_cells(camera: Float32Camera, projection: NDArray[np.float32]) -> None:
    """Write the pixels of each cell as in ``pixels_between``; those of near cells mean nothing."""
    zero = np.float32(0.0)
    for row in range(BLOCK):
        for column in range(BLOCK):
            at = row * CORNERS + column
            first = max(zero, np.ceil(camera.left + _least_of(projection, ACROSS + at)))
            last = min(camera.last_column, np.floor(camera.right + _most_of(projection, ACROSS + at)))
            top = max(zero, np.ceil(camera.top - _most_of(projection, HIGH + at)))
            bottom = min(camera.last_row, np.floor(camera.bottom - _least_of(projection, LOW + at)))
            projection[FIRST + at], projection[LAST + at] = first, last
            projection[TOP + at], projection[BOTTOM + at] = top, bottom
            bit = projection[BIT + at]
            projection[SHOWN + at] = bit if (first <= last) & (top <= bottom) else zero


@inlined_kernel
def _show_near_cells(camera: Float32Camera, projection: NDArray[np.float32]) -> None:
    """Write which cells near the camera may be visible; their pixels are computed later."""
    zero, near, slack, wide = np.float32(0.0), np.float32(NEAR), np.float32(SLACK), camera.half_width
    for row in range(BLOCK):
        for column in range(BLOCK):
            at = row * CORNERS + column
            is_near = _least_of(projection, AHEAD + at) <= near
            # At the sides, as in ``is_outside_view``.
            least, most = np.float32(np.inf), np.float32(-np.inf)
            for corner in (at, at + 1, at + CORNERS, at + CORNERS + 1):
                reach = wide * projection[AHEAD + corner]
                least = min(least, projection[RIGHT + corner] - reach)
                most = max(most, projection[RIGHT + corner] + reach)
            may_show = (_most_of(projection, AHEAD + at) > -near) & (least <= slack) & (most >= -slack)
            if is_near:
                projection[SHOWN + at] = projection[BIT + at] if may_show else zero


@inlined_kernel
def _shown_cells(rows: int, columns: int, projection: NDArray[np.float32]) -> int:
    """Return the cells that may be visible and are on the map, as the bits of one number, row after row.

    ``rows`` and ``columns`` count from the block's first ones to the edge of the map.
    """
    shown, on_map = 0, (1 << min(BLOCK, columns)) - 1
    for row in range(min(BLOCK, rows) - 1, -1, -1):
        first = nonnegative(SHOWN + row * CORNERS)
        bits = projection[first : first + BLOCK]
        west, east = bits[0] + bits[1] + (bits[2] + bits[3]), bits[4] + bits[5] + (bits[6] + bits[7])
        shown = (shown << BLOCK) | (int(west + east) & on_map)
    return shown


@inlined_kernel
def _least_of(projection: NDArray[np.float32], first: int) -> np.float32:
    """Return the least number of a cell's corners."""
    south, north = first, first + CORNERS
    return min(projection[south], projection[south + 1], projection[north], projection[north + 1])


@inlined_kernel
def _most_of(projection: NDArray[np.float32], first: int) -> np.float32:
    """Return the greatest number of a cell's corners."""
    south, north = first, first + CORNERS
    return max(projection[south], projection[south + 1], projection[north], projection[north + 1])


@inlined_kernel
def _pixels_of_near_cell(blocks: Blocks, square: Square, camera: Camera, at: int) -> Rectangle:
    """Return the pixels of a cell that is near the camera or has corners behind it."""
    east = square.east + at % CORNERS * CELL
    north = square.north + at // CORNERS * CELL
    heights = blocks.heights[square.block]
    south_west = to_camera_axes(camera, east, heights[at] - camera.y, north)
    south_east = to_camera_axes(camera, east + CELL, heights[at + 1] - camera.y, north)
    north_west = to_camera_axes(camera, east, heights[at + CORNERS] - camera.y, north + CELL)
    north_east = to_camera_axes(camera, east + CELL, heights[at + CORNERS + 1] - camera.y, north + CELL)
    if is_outside_view(camera, south_west, south_east, north_west, north_east):
        return Rectangle(0, 0, 0, 0)
    outline = extended(extended(empty_outline(), south_west), south_east)
    return pixels_of(camera, extended(extended(outline, north_west), north_east))


class Triangle(NamedTuple):
    """One of the two triangles of a cell, relative to a camera."""

    above: float  # m, height of the camera over its plane, or OUT_OF_REACH where it is not above
    slope_east: float  # m up per m east
    slope_north: float
    met: int  # its code in the hit buffer


class Cell(NamedTuple):
    """A cell of the terrain or of water, relative to a camera."""

    east: float  # m from its south-western corner to the camera
    north: float
    south_east: Triangle
    north_west: Triangle


@inlined_kernel
def _trace_cell(
    blocks: Blocks, square: Square, camera: Camera, at: int, pixels: Rectangle, buffer: HitBuffer
) -> None:
    row, column = at // CORNERS, at % CORNERS
    heights = blocks.heights[square.block]
    h00, h01, h10, h11 = heights[at], heights[at + 1], heights[at + CORNERS], heights[at + CORNERS + 1]
    east, north = -(square.east + column * CELL), -(square.north + row * CELL)
    triangle = 2 * ((square.row + row) * blocks.extent[COLUMNS] + square.column + column)
    up = camera.y - h00
    se_east, se_north, nw_east, nw_north = (
        (h01 - h00) / CELL,
        (h11 - h01) / CELL,
        (h11 - h10) / CELL,
        (h10 - h00) / CELL,
    )
    se_above, nw_above = up - (se_east * east + se_north * north), up - (nw_east * east + nw_north * north)
    if se_above > 0.0 or nw_above > 0.0:
        se_above = se_above if se_above > 0.0 else OUT_OF_REACH
        nw_above = nw_above if nw_above > 0.0 else OUT_OF_REACH
        south_east = Triangle(se_above, se_east, se_north, code_of_triangle(triangle))
        north_west = Triangle(nw_above, nw_east, nw_north, code_of_triangle(triangle + 1))
        _trace_pixels(Cell(east, north, south_east, north_west), pixels, buffer)


@inlined_kernel
def _intersect_triangle(
    cell: Cell, half: Triangle, towards: float, east: float, up: float, north: float
) -> tuple[float, float]:
    """Return how far a ray passes inside the edges of a triangle, and how far it sinks towards it per metre.

    Args:
        towards: 1 for the south-eastern triangle, -1 for the other.
        east: Component of the ray's unit vector; so up and north.

    Returns:
        First a number that is negative where the ray does not meet the triangle from above: m to the
        nearest edge, times the second number, to save a division. Where it is not, the second is positive.
    """
    sinking = half.slope_east * east + half.slope_north * north - up
    # Where the ray meets the plane, m from the corner of the cell; times ``sinking``.
    x, z = cell.east * sinking + half.above * east, cell.north * sinking + half.above * north
    overlap = OVERLAP * sinking
    inside = min(min(x, z) + overlap, CELL * sinking + overlap - max(x, z))
    return min(inside, (x - z) * towards + overlap), sinking


@disjoint_kernel
def _trace_pixels(cell: Cell, pixels: Rectangle, buffer: HitBuffer) -> None:
    """Intersect the rays of some pixels with a cell, in loops that vectorize."""
    count = whole_vectors(buffer, pixels.right - pixels.left)
    for row in range(pixels.top, pixels.bottom):
        first = start_in_row(buffer, pixels, row, count)
        last = first + count
        easts, ups, norths = buffer.east[first:last], buffer.up[first:last], buffer.north[first:last]
        distances, mets = buffer.distance[first:last], buffer.met[first:last]
        for ray in range(count):
            east, up, north = easts[ray], ups[ray], norths[ray]
            inside, sinking = _intersect_triangle(cell, cell.south_east, 1.0, east, up, north)
            inside_2, sinking_2 = _intersect_triangle(cell, cell.north_west, -1.0, east, up, north)
            is_first = inside >= 0.0
            above = cell.south_east.above if is_first else cell.north_west.above
            distance = above / (sinking if is_first else sinking_2)
            distance = distance if max(inside, inside_2) >= 0.0 else np.inf
            met = cell.south_east.met if is_first else cell.north_west.met
            distances[ray], mets[ray] = nearer_of(distance, met, distances[ray], mets[ray])


@kernel
def trace_water(blocks: Blocks, square: Square, camera: Camera, buffer: HitBuffer) -> None:
    """Intersect the rays of an image with the water of a block, from above; see ``trace_terrain``."""
    for row in range(min(BLOCK, blocks.extent[ROWS] - square.row)):
        for column in range(min(BLOCK, blocks.extent[COLUMNS] - square.column)):
            above = camera.y - blocks.water[square.block, row * BLOCK + column]
            if 0.0 < above < np.inf:
                _trace_water_of_cell(blocks, square, camera, row, column, above, buffer)


@inlined_kernel
def _trace_water_of_cell(
    blocks: Blocks,
    square: Square,
    camera: Camera,
    row: int,
    column: int,
    above: float,
    buffer: HitBuffer,
) -> None:
    east, north = square.east + column * CELL, square.north + row * CELL
    outline = empty_outline()
    for corner in range(4):
        beyond = (east + (corner & 1) * CELL, north + (corner >> 1) * CELL)
        outline = extended(outline, to_camera_axes(camera, beyond[0], -above, beyond[1]))
    pixels = pixels_of(camera, outline)
    if pixels.left < pixels.right:
        surface = Triangle(
            above,
            0.0,
            0.0,
            code_of_water((square.row + row) * blocks.extent[COLUMNS] + square.column + column),
        )
        _trace_pixels(Cell(-east, -north, surface, surface), pixels, buffer)
