"""Intersecting the rays of an image with the terrain and the water of a block of cells.

All corners of the cells are projected onto the image first. Then each cell is intersected with the rays of
the few pixels that it may cover.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.tracing.coarse_projection import BESIDE, NEAR, Float32Camera
from wildscav_engine.rendering.tracing.frustum import (
    Camera,
    Rectangle,
    empty_outline,
    extended,
    is_outside_view,
    nonnegative,
    pixels_of,
    to_camera_axes,
)
from wildscav_engine.rendering.tracing.hit_buffer import (
    HitBuffer,
    code_of_triangle,
    code_of_water,
    even_count,
    start_in_row,
)
from wildscav_engine.rendering.tracing.scene_arrays import COLUMNS, CORNERS, ROWS, SQUARE, Blocks

CELLS = 80  # of which 72 count; padded so that loops over them vectorize evenly
OVERLAP = 1e-8  # m that a triangle reaches beyond its edges, so that no ray slips between two
# The projection of a block holds the positions of its cells' corners, and of the cells, on an image; row
# after row, CORNERS per row. These are the offsets of its parts: m east and north of the first corner; m
# ahead of the camera; tangents to the right and upwards; first and last columns and rows of a cell's pixels;
# whether it may be visible.
EAST, NORTH, AHEAD, RIGHT, ABOVE, FIRST, LAST, TOP, BOTTOM, SHOWN = (SQUARE * row for row in range(10))


def allocate_projection() -> NDArray[np.float32]:
    """Return an array for the projection of a block, with the positions of its corners on the map."""
    projection = np.zeros(10 * SQUARE, np.float32)
    projection[EAST:NORTH] = np.arange(SQUARE) % CORNERS * CELL
    projection[NORTH:AHEAD] = np.minimum(np.arange(SQUARE) // CORNERS, BLOCK) * CELL
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
    camera: Camera,
    camera32: Float32Camera,
    projection: NDArray[np.float32],
    cells: NDArray[np.int64],
    buffer: HitBuffer,
) -> None:
    """Intersect the rays of an image with the terrain of a block."""
    _project_corners(
        blocks.rises[square.block], square, blocks.spans[square.block, 0] - camera.y, camera32, projection
    )
    _find_pixels_of_cells(camera32, projection)
    rows, columns = blocks.extent[ROWS] - square.row, blocks.extent[COLUMNS] - square.column
    count = 0
    for row in range(BLOCK):
        for column in range(BLOCK):
            # Always written, counted only if visible: this avoids branches.
            cells[nonnegative(count)] = row * CORNERS + column
            count += int(projection[SHOWN + row * CORNERS + column]) & (column < columns) & (row < rows)
    for item in range(count):
        cell = nonnegative(cells[item])
        if _nearest_of(projection, cell) <= NEAR:
            pixels = _pixels_of_near_cell(blocks, square, camera, cell)
        else:
            pixels = Rectangle(
                int(projection[FIRST + cell]),
                int(projection[LAST + cell]) + 1,
                int(projection[TOP + cell]),
                int(projection[BOTTOM + cell]) + 1,
            )
        if pixels.left < pixels.right:
            _trace_cell(blocks, square, camera, cell, pixels, buffer)


@inlined_kernel
def _nearest_of(projection: NDArray[np.float32], cell: int) -> float:
    """Return how far ahead in m the nearest corner of a cell is."""
    first = AHEAD + cell
    return float(
        min(
            projection[first],
            projection[first + 1],
            projection[first + CORNERS],
            projection[first + CORNERS + 1],
        )
    )


@inlined_kernel
def _project_corners(
    rises: NDArray[np.float32],
    square: Square,
    ground: float,
    camera: Float32Camera,
    projection: NDArray[np.float32],
) -> None:
    """Project the corners of a block onto the image, in a loop that vectorizes.

    Args:
        rises: (96,) m, heights of the corners above the lowest.
        ground: m, height of the lowest corner above the camera.
    """
    sin_yaw, cos_yaw = camera.sin_yaw, camera.cos_yaw
    sin_pitch, cos_pitch = camera.sin_pitch, camera.cos_pitch
    east, north, bottom = np.float32(square.east), np.float32(square.north), np.float32(ground)
    one = np.float32(1.0)
    for at in range(SQUARE):
        x, z, up = east + projection[EAST + at], north + projection[NORTH + at], bottom + rises[at]
        level = sin_yaw * x + cos_yaw * z
        ahead = cos_pitch * level - sin_pitch * up
        inverse = one / ahead
        projection[AHEAD + at] = ahead
        projection[RIGHT + at] = (cos_yaw * x - sin_yaw * z) * inverse
        projection[ABOVE + at] = (cos_pitch * up + sin_pitch * level) * inverse


@inlined_kernel
def _find_pixels_of_cells(camera: Float32Camera, projection: NDArray[np.float32]) -> None:
    """Write the pixels of each cell; those of cells near the camera are computed later.

    As in ``pixels_between``; see ``BESIDE`` for how.
    """
    zero, near, a_half = np.float32(0.0), np.float32(NEAR), np.float32(0.5)
    limit = camera.half_width + np.float32(BESIDE)
    for at in range(CELLS):
        a, b = RIGHT + at, RIGHT + at + CORNERS
        least = min(projection[a], projection[a + 1], projection[b], projection[b + 1])
        most = max(projection[a], projection[a + 1], projection[b], projection[b + 1])
        least = a_half * (abs(least + limit) - abs(least - limit))
        first = max(zero, np.ceil(camera.left + least * (camera.scale + camera.curve * least * least)))
        most = a_half * (abs(most + limit) - abs(most - limit))
        last = min(
            camera.last_column, np.floor(camera.right + most * (camera.scale + camera.curve * most * most))
        )
        a, b = ABOVE + at, ABOVE + at + CORNERS
        least = min(projection[a], projection[a + 1], projection[b], projection[b + 1])
        most = max(projection[a], projection[a + 1], projection[b], projection[b + 1])
        top = max(zero, np.ceil(camera.top - (most * camera.scale_up + abs(most) * camera.spread)))
        bottom = min(
            camera.last_row, np.floor(camera.bottom - (least * camera.scale_up - abs(least) * camera.spread))
        )
        a, b = AHEAD + at, AHEAD + at + CORNERS
        nearest = min(projection[a], projection[a + 1], projection[b], projection[b + 1])
        farthest = max(projection[a], projection[a + 1], projection[b], projection[b + 1])
        has_pixels = (first <= last) & (top <= bottom)
        projection[FIRST + at], projection[LAST + at] = first, last
        projection[TOP + at], projection[BOTTOM + at] = top, bottom
        projection[SHOWN + at] = np.float32((farthest > -near) & ((nearest <= near) | has_pixels))


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

    above: float  # m, height of the camera over its plane
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
    south_east = Triangle(
        up - (se_east * east + se_north * north), se_east, se_north, code_of_triangle(triangle)
    )
    north_west = Triangle(
        up - (nw_east * east + nw_north * north), nw_east, nw_north, code_of_triangle(triangle + 1)
    )
    _trace_pixels(Cell(east, north, south_east, north_west), pixels, buffer)


@inlined_kernel
def _intersect_triangle(
    cell: Cell, half: Triangle, towards: float, east: float, up: float, north: float
) -> tuple[bool, float]:
    """Return whether a ray hits a triangle of a cell from above, and how far it sinks towards it per metre.

    Args:
        towards: 1 for the south-eastern triangle, -1 for the other.
        east: Component of the ray's unit vector; so up and north.
    """
    sinking = half.slope_east * east + half.slope_north * north - up
    # Where the ray meets the plane, m from the corner of the cell; times ``sinking``, to save a division.
    x, z = cell.east * sinking + half.above * east, cell.north * sinking + half.above * north
    overlap = OVERLAP * sinking
    is_met = (
        (half.above > 0.0)
        & (sinking > 0.0)
        & (min(x, z) >= -overlap)
        & (max(x, z) <= CELL * sinking + overlap)
        & ((x - z) * towards >= -overlap)
    )
    return is_met, sinking


@disjoint_kernel
def _trace_pixels(cell: Cell, pixels: Rectangle, buffer: HitBuffer) -> None:
    """Intersect the rays of some pixels with a cell, in loops that vectorize."""
    count = even_count(buffer, pixels)
    for row in range(pixels.top, pixels.bottom):
        first = start_in_row(buffer, pixels, row, count)
        last = first + count
        easts, ups, norths = buffer.east[first:last], buffer.up[first:last], buffer.north[first:last]
        distances, mets = buffer.distance[first:last], buffer.met[first:last]
        for ray in range(count):
            east, up, north = easts[ray], ups[ray], norths[ray]
            is_first, sinking = _intersect_triangle(cell, cell.south_east, 1.0, east, up, north)
            is_second, sinking_2 = _intersect_triangle(cell, cell.north_west, -1.0, east, up, north)
            above = cell.south_east.above if is_first else cell.north_west.above
            distance = above / (sinking if is_first else sinking_2)
            is_nearer = (is_first | is_second) & (distance < distances[ray])
            met = cell.south_east.met if is_first else cell.north_west.met
            distances[ray] = distance if is_nearer else distances[ray]
            mets[ray] = met if is_nearer else mets[ray]


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
