"""The terrain and the water of a block of cells on an image.

The middles of all cells' corners are placed on the image first; then each cell is met by the rays of the few
pixels that it can lie on.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.tracing.canvas import Canvas, of_triangle, of_water
from wildscav_engine.rendering.tracing.frustum import (
    Camera,
    Rectangle,
    beside,
    natural,
    no_outline,
    pixels_of,
    turned,
    widened,
)
from wildscav_engine.rendering.tracing.packing import CORNERS, SQUARE, Blocks
from wildscav_engine.rendering.tracing.rough import NEAR, RoughCamera

NARROW = 8  # columns; up to so many, ray after ray is faster than row after row
CELLS = 80  # of which 72 count; more make the loops over them even
OVERLAP = 1e-8  # m that a triangle reaches beyond its edges, so that no ray slips through between two
# A sketch of a block says where the corners of its cells, and the cells, lie on an image; row after row,
# CORNERS a row. Each starts here: m east and north of the first corner; m before the camera; tangents to the
# right and upwards; first and last columns and rows of a cell's pixels; whether a cell may have pixels.
EAST, NORTH, AHEAD, RIGHT, ABOVE, FIRST, LAST, TOP, BOTTOM, SHOWN = (SQUARE * row for row in range(10))


def allocate_sketch() -> NDArray[np.float32]:
    """Return room for the sketch of a block."""
    sketch = np.zeros(10 * SQUARE, np.float32)
    sketch[EAST:NORTH] = np.arange(SQUARE) % CORNERS * CELL
    sketch[NORTH:AHEAD] = np.minimum(np.arange(SQUARE) // CORNERS, BLOCK) * CELL
    return sketch


class Square(NamedTuple):
    """A block of cells in front of a camera."""

    block: int
    row: int  # of its south-western cell
    column: int
    east: float  # m from the camera to its south-western corner
    north: float


@inlined_kernel
def height_in(blocks: Blocks, row: int, column: int, camera: Camera) -> tuple[float, int]:
    """Return how high the ground under a camera is, m, in its cell, and in which half of it the camera is."""
    block = row // BLOCK * ((blocks.columns + BLOCK - 1) // BLOCK) + column // BLOCK
    at = row % BLOCK * CORNERS + column % BLOCK
    heights = blocks.heights[block]
    h00, h01, h10, h11 = heights[at], heights[at + 1], heights[at + CORNERS], heights[at + CORNERS + 1]
    east = (camera.x - blocks.edges[0]) / CELL - column
    north = (camera.z - blocks.edges[1]) / CELL - row
    if east >= north:
        return h00 + (h01 - h00) * east + (h11 - h01) * north, 0
    return h00 + (h11 - h10) * east + (h10 - h00) * north, 1


@kernel
def paint_terrain(
    blocks: Blocks,
    square: Square,
    camera: Camera,
    rough: RoughCamera,
    sketch: NDArray[np.float32],
    cells: NDArray[np.int64],
    canvas: Canvas,
) -> None:
    """Let the rays of an image meet the terrain of a block.

    Args:
        blocks: The world.
        square: Which block.
        camera: The image's.
        rough: The same.
        sketch: Room for the places of cells on the image.
        cells: (65,) room for those that may be seen.
        canvas: The image, written.
    """
    _sketch_corners(
        blocks.rises[square.block], square, blocks.spans[square.block, 0] - camera.y, rough, sketch
    )
    _sketch_cells(rough, sketch)
    rows, columns = blocks.rows - square.row, blocks.columns - square.column
    count = 0
    for row in range(BLOCK):
        for column in range(BLOCK):
            # Written always, counted if shown: so nothing is to be guessed.
            cells[natural(count)] = row * CORNERS + column
            count += int(sketch[SHOWN + row * CORNERS + column]) & (column < columns) & (row < rows)
    for item in range(count):
        cell = natural(cells[item])
        if _nearest_of(sketch, cell) <= NEAR:
            pixels = _pixels_of_near_cell(blocks, square, camera, cell)
        else:
            pixels = Rectangle(
                int(sketch[FIRST + cell]),
                int(sketch[LAST + cell]) + 1,
                int(sketch[TOP + cell]),
                int(sketch[BOTTOM + cell]) + 1,
            )
        if pixels.left < pixels.right:
            _paint_cell(blocks, square, camera, cell, pixels, canvas)


@inlined_kernel
def _nearest_of(sketch: NDArray[np.float32], cell: int) -> float:
    """Return m that the nearest corner of a cell is ahead."""
    first = AHEAD + cell
    return float(min(sketch[first], sketch[first + 1], sketch[first + CORNERS], sketch[first + CORNERS + 1]))


@inlined_kernel
def _sketch_corners(
    rises: NDArray[np.float32],
    square: Square,
    ground: float,
    camera: RoughCamera,
    sketch: NDArray[np.float32],
) -> None:
    """Place the corners on the image: several at once.

    Args:
        rises: (96,) m, heights of the corners above the lowest.
        square: The block.
        ground: m, height of the lowest corner above the camera.
        camera: The image's.
        sketch: Written.
    """
    sin_yaw, cos_yaw = camera.sin_yaw, camera.cos_yaw
    sin_pitch, cos_pitch = camera.sin_pitch, camera.cos_pitch
    east, north, bottom = np.float32(square.east), np.float32(square.north), np.float32(ground)
    one = np.float32(1.0)
    for at in range(SQUARE):
        x, z, up = east + sketch[EAST + at], north + sketch[NORTH + at], bottom + rises[at]
        level = sin_yaw * x + cos_yaw * z
        ahead = cos_pitch * level - sin_pitch * up
        inverse = one / ahead
        sketch[AHEAD + at] = ahead
        sketch[RIGHT + at] = (cos_yaw * x - sin_yaw * z) * inverse
        sketch[ABOVE + at] = (cos_pitch * up + sin_pitch * level) * inverse


@inlined_kernel
def _sketch_cells(camera: RoughCamera, sketch: NDArray[np.float32]) -> None:
    """Note the pixels of each cell; those of one that is near the camera are still to be found."""
    zero, near = np.float32(0.0), np.float32(NEAR)
    for at in range(CELLS):
        a, b = RIGHT + at, RIGHT + at + CORNERS
        least = min(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        most = max(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        first = max(zero, np.ceil(camera.left + least * camera.scale))
        last = min(camera.last_column, np.floor(camera.right + most * camera.scale))
        a, b = ABOVE + at, ABOVE + at + CORNERS
        least = min(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        most = max(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        top = max(zero, np.ceil(camera.top - most * camera.scale))
        bottom = min(camera.last_row, np.floor(camera.bottom - least * camera.scale))
        a, b = AHEAD + at, AHEAD + at + CORNERS
        nearest = min(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        farthest = max(sketch[a], sketch[a + 1], sketch[b], sketch[b + 1])
        has_pixels = (first <= last) & (top <= bottom)
        sketch[FIRST + at], sketch[LAST + at] = first, last
        sketch[TOP + at], sketch[BOTTOM + at] = top, bottom
        sketch[SHOWN + at] = np.float32((farthest > -near) & ((nearest <= near) | has_pixels))


@inlined_kernel
def _pixels_of_near_cell(blocks: Blocks, square: Square, camera: Camera, at: int) -> Rectangle:
    """Return the pixels of a cell that is near the camera, or has corners behind it."""
    east = square.east + at % CORNERS * CELL
    north = square.north + at // CORNERS * CELL
    heights = blocks.heights[square.block]
    south_west = turned(camera, east, heights[at] - camera.y, north)
    south_east = turned(camera, east + CELL, heights[at + 1] - camera.y, north)
    north_west = turned(camera, east, heights[at + CORNERS] - camera.y, north + CELL)
    north_east = turned(camera, east + CELL, heights[at + CORNERS + 1] - camera.y, north + CELL)
    if beside(camera, south_west, south_east, north_west, north_east):
        return Rectangle(0, 0, 0, 0)
    outline = widened(widened(no_outline(), south_west), south_east)
    return pixels_of(camera, widened(widened(outline, north_west), north_east))


class Half(NamedTuple):
    """One of the two triangles of a cell, as a camera sees it."""

    above: float  # m, height of the camera over its plane
    slope_east: float  # m up per m east
    slope_north: float
    met: int  # what stands for it on a canvas


class Cell(NamedTuple):
    """A cell of the terrain or of water, as a camera sees it."""

    east: float  # m from its south-western corner to the camera
    north: float
    south_east: Half
    north_west: Half


@inlined_kernel
def _paint_cell(
    blocks: Blocks, square: Square, camera: Camera, at: int, pixels: Rectangle, canvas: Canvas
) -> None:
    row, column = at // CORNERS, at % CORNERS
    heights = blocks.heights[square.block]
    h00, h01, h10, h11 = heights[at], heights[at + 1], heights[at + CORNERS], heights[at + CORNERS + 1]
    east, north = -(square.east + column * CELL), -(square.north + row * CELL)
    triangle = 2 * ((square.row + row) * blocks.columns + square.column + column)
    up = camera.y - h00
    se_east, se_north, nw_east, nw_north = (
        (h01 - h00) / CELL,
        (h11 - h01) / CELL,
        (h11 - h10) / CELL,
        (h10 - h00) / CELL,
    )
    south_east = Half(up - (se_east * east + se_north * north), se_east, se_north, of_triangle(triangle))
    north_west = Half(up - (nw_east * east + nw_north * north), nw_east, nw_north, of_triangle(triangle + 1))
    _paint(Cell(east, north, south_east, north_west), pixels, canvas)


@inlined_kernel
def _meet_half(
    cell: Cell, half: Half, towards: float, east: float, up: float, north: float
) -> tuple[bool, float]:
    """Return whether a ray meets half a cell from above, and after how many m.

    Args:
        cell: The cell.
        half: Which half of it.
        towards: 1 for the south-eastern half, -1 for the other.
        east: Of the ray's unit vector; so up and north.
        up: See east.
        north: See east.
    """
    sinking = half.slope_east * east + half.slope_north * north - up
    distance = half.above / sinking
    x, z = cell.east + distance * east, cell.north + distance * north
    is_in = (
        (half.above > 0.0)
        & (sinking > 0.0)
        & (min(x, z) >= -OVERLAP)
        & (max(x, z) <= CELL + OVERLAP)
        & ((x - z) * towards >= -OVERLAP)
    )
    return is_in, distance


@inlined_kernel
def _paint(cell: Cell, pixels: Rectangle, canvas: Canvas) -> None:
    """Let the rays of some pixels meet a cell."""
    if pixels.right - pixels.left > NARROW:
        _paint_by_rows(cell, pixels, canvas)
        return
    for row in range(pixels.top, pixels.bottom):
        for column in range(pixels.left, pixels.right):
            ray = natural(row * canvas.width + column)
            east, up, north = canvas.east[ray], canvas.up[ray], canvas.north[ray]
            nearest, met = canvas.distance[ray], canvas.met[ray]
            is_in, distance = _meet_half(cell, cell.south_east, 1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            nearest, met = distance if nearer else nearest, cell.south_east.met if nearer else met
            is_in, distance = _meet_half(cell, cell.north_west, -1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            canvas.distance[ray] = distance if nearer else nearest
            canvas.met[ray] = cell.north_west.met if nearer else met


@kernel
def _paint_by_rows(cell: Cell, pixels: Rectangle, canvas: Canvas) -> None:
    """Do for whole rows what ``_paint`` does for a ray: several rays at once."""
    for row in range(pixels.top, pixels.bottom):
        first, last = row * canvas.width + pixels.left, row * canvas.width + pixels.right
        easts, ups, norths = canvas.east[first:last], canvas.up[first:last], canvas.north[first:last]
        distances, mets = canvas.distance[first:last], canvas.met[first:last]
        for ray in range(last - first):
            east, up, north = easts[ray], ups[ray], norths[ray]
            nearest, met = distances[ray], mets[ray]
            is_in, distance = _meet_half(cell, cell.south_east, 1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            nearest, met = distance if nearer else nearest, cell.south_east.met if nearer else met
            is_in, distance = _meet_half(cell, cell.north_west, -1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            distances[ray] = distance if nearer else nearest
            mets[ray] = cell.north_west.met if nearer else met


@kernel
def paint_water(blocks: Blocks, square: Square, camera: Camera, canvas: Canvas) -> None:
    """Let the rays of an image meet the water of a block from above; see ``paint_terrain``."""
    for row in range(min(BLOCK, blocks.rows - square.row)):
        for column in range(min(BLOCK, blocks.columns - square.column)):
            above = camera.y - blocks.water[square.block, row * BLOCK + column]
            if 0.0 < above < np.inf:
                _paint_water_of_cell(blocks, square, camera, row, column, above, canvas)


@inlined_kernel
def _paint_water_of_cell(
    blocks: Blocks,
    square: Square,
    camera: Camera,
    row: int,
    column: int,
    above: float,
    canvas: Canvas,
) -> None:
    east, north = square.east + column * CELL, square.north + row * CELL
    outline = no_outline()
    for corner in range(4):
        beyond = (east + (corner & 1) * CELL, north + (corner >> 1) * CELL)
        outline = widened(outline, turned(camera, beyond[0], -above, beyond[1]))
    pixels = pixels_of(camera, outline)
    if pixels.left < pixels.right:
        surface = Half(
            above, 0.0, 0.0, of_water((square.row + row) * blocks.columns + square.column + column)
        )
        _paint(Cell(-east, -north, surface, surface), pixels, canvas)
