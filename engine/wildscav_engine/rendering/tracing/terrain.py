"""The terrain and the water of a block of cells on an image.

The middles of all cells' corners are placed on the image first; then each cell is met by the rays of the few
pixels that it can lie on.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.kernel import array_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.tracing.canvas import Canvas, of_triangle, of_water
from wildscav_engine.rendering.tracing.frustum import (
    Camera,
    Rectangle,
    no_outline,
    pixels_of,
    turned,
    widened,
)
from wildscav_engine.rendering.tracing.packing import CORNERS, SQUARE, Blocks

NARROW = 8  # columns; up to so many, ray after ray is faster than row after row
NEAR = 1.0  # m; a cell that is nearer ahead is placed more precisely than in the sketch
ROUNDED = 2e-5  # of the tangent of what is farther, the most by which rounding changes it in the sketch
CELLS = 80  # of which 72 count; more make the loops over them even
OVERLAP = 1e-8  # m that a triangle reaches beyond its edges, so that no ray slips through between two


class Sketch(NamedTuple):
    """Where the corners of a block's cells, and the cells, lie on an image; row after row, CORNERS a row.

    Half as precise as all else, and so twice as fast: it only says which pixels to look at.
    """

    east: NDArray[np.float32]  # (96,) m from the first corner
    north: NDArray[np.float32]  # (96,) m
    up: NDArray[np.float32]  # (96,) m above the camera
    ahead: NDArray[np.float32]  # (96,) m before the camera
    inverse: NDArray[np.float32]  # (96,) 1 / m
    right: NDArray[np.float32]  # (96,) tangents
    above: NDArray[np.float32]  # (96,)
    first: NDArray[np.float32]  # (96,) first and last column and row of a cell's pixels
    last: NDArray[np.float32]
    top: NDArray[np.float32]
    bottom: NDArray[np.float32]
    shown: NDArray[np.bool_]  # (96,) whether a cell may have pixels
    cells: NDArray[np.int64]  # (65,) the cells that have


@array_kernel
def allocate_sketch() -> Sketch:
    """Return room for the cells of a block."""
    r = np.empty((11, SQUARE), np.float32)
    shown = np.empty(SQUARE, np.bool_)
    for at in range(SQUARE):
        r[0, at], r[1, at] = at % CORNERS * CELL, min(at // CORNERS, BLOCK) * CELL
    return Sketch(
        r[0],
        r[1],
        r[2],
        r[3],
        r[4],
        r[5],
        r[6],
        r[7],
        r[8],
        r[9],
        r[10],
        shown,
        np.empty(BLOCK * BLOCK + 1, np.int64),
    )


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


@inlined_kernel
def paint_terrain(blocks: Blocks, square: Square, camera: Camera, sketch: Sketch, canvas: Canvas) -> None:
    """Let the rays of an image meet the terrain of a block.

    Args:
        blocks: The world.
        square: Which block.
        camera: The image's.
        sketch: Room for the places of cells on the image.
        canvas: The image, written.
    """
    _sketch_corners(blocks, square, camera, sketch)
    _sketch_cells(camera, sketch)
    rows, columns = min(BLOCK, blocks.rows - square.row), min(BLOCK, blocks.columns - square.column)
    count = 0
    for row in range(rows):
        for column in range(columns):
            # Written always, counted if shown: so nothing is to be guessed.
            sketch.cells[count] = row * CORNERS + column
            count += sketch.shown[row * CORNERS + column]
    for cell in range(count):
        at = sketch.cells[cell]
        nearest = min(
            sketch.ahead[at],
            sketch.ahead[at + 1],
            sketch.ahead[at + CORNERS],
            sketch.ahead[at + CORNERS + 1],
        )
        if nearest <= NEAR:
            pixels = _pixels_of_near_cell(blocks, square, camera, at)
        else:
            pixels = Rectangle(
                int(sketch.first[at]),
                int(sketch.last[at]) + 1,
                int(sketch.top[at]),
                int(sketch.bottom[at]) + 1,
            )
        _paint_cell(blocks, square, camera, at, pixels, canvas)


@inlined_kernel
def _sketch_corners(blocks: Blocks, square: Square, camera: Camera, sketch: Sketch) -> None:
    """Place the corners on the image: plain loops that write one array each, several corners at once."""
    heights = blocks.heights[square.block]
    east, north, up = sketch.east, sketch.north, sketch.up
    ahead, inverse, right, above = sketch.ahead, sketch.inverse, sketch.right, sketch.above
    sin_yaw, cos_yaw = np.float32(camera.sin_yaw), np.float32(camera.cos_yaw)
    sin_pitch, cos_pitch = np.float32(camera.sin_pitch), np.float32(camera.cos_pitch)
    level = np.float32(camera.sin_yaw * square.east + camera.cos_yaw * square.north)
    beside = np.float32(camera.cos_yaw * square.east - camera.sin_yaw * square.north)
    one = np.float32(1.0)
    for at in range(SQUARE):
        up[at] = heights[at] - camera.y
    for at in range(SQUARE):
        ahead[at] = cos_pitch * (level + sin_yaw * east[at] + cos_yaw * north[at]) - sin_pitch * up[at]
    for at in range(SQUARE):
        inverse[at] = one / ahead[at]
    for at in range(SQUARE):
        right[at] = (beside + cos_yaw * east[at] - sin_yaw * north[at]) * inverse[at]
    for at in range(SQUARE):
        far = level + sin_yaw * east[at] + cos_yaw * north[at]
        above[at] = (cos_pitch * up[at] + sin_pitch * far) * inverse[at]


@inlined_kernel
def _sketch_cells(camera: Camera, sketch: Sketch) -> None:
    """Note the pixels of each cell; those of one that is near the camera are still to be found."""
    ahead, right, above, shown = sketch.ahead, sketch.right, sketch.above, sketch.shown
    first, last, top, bottom = sketch.first, sketch.last, sketch.top, sketch.bottom
    scale, margin = np.float32(camera.scale), 0.01 + ROUNDED * camera.scale
    zero, near = np.float32(0.0), np.float32(NEAR)
    last_column, last_row = np.float32(camera.width - 1), np.float32(camera.height - 1)
    # Where pixels 0 begin and end to be touched.
    left_edge, right_edge = (
        np.float32(camera.width * 0.5 - 0.5 - margin),
        np.float32(camera.width * 0.5 - 0.5 + margin),
    )
    top_edge, bottom_edge = (
        np.float32(camera.height * 0.5 - 0.5 - margin),
        np.float32(camera.height * 0.5 - 0.5 + margin),
    )
    for at in range(CELLS):
        least = min(right[at], right[at + 1], right[at + CORNERS], right[at + CORNERS + 1])
        first[at] = max(zero, np.ceil(left_edge + least * scale))
    for at in range(CELLS):
        most = max(right[at], right[at + 1], right[at + CORNERS], right[at + CORNERS + 1])
        last[at] = min(last_column, np.floor(right_edge + most * scale))
    for at in range(CELLS):
        most = max(above[at], above[at + 1], above[at + CORNERS], above[at + CORNERS + 1])
        top[at] = max(zero, np.ceil(top_edge - most * scale))
    for at in range(CELLS):
        least = min(above[at], above[at + 1], above[at + CORNERS], above[at + CORNERS + 1])
        bottom[at] = min(last_row, np.floor(bottom_edge - least * scale))
    for at in range(CELLS):
        nearest = min(ahead[at], ahead[at + 1], ahead[at + CORNERS], ahead[at + CORNERS + 1])
        farthest = max(ahead[at], ahead[at + 1], ahead[at + CORNERS], ahead[at + CORNERS + 1])
        has_pixels = (first[at] <= last[at]) & (top[at] <= bottom[at])
        shown[at] = (farthest > -near) & ((nearest <= near) | has_pixels)


@inlined_kernel
def _pixels_of_near_cell(blocks: Blocks, square: Square, camera: Camera, at: int) -> Rectangle:
    """Return the pixels of a cell that is near the camera, or has corners behind it."""
    outline = no_outline()
    for corner in (at, at + 1, at + CORNERS, at + CORNERS + 1):
        east = square.east + corner % CORNERS * CELL
        north = square.north + corner // CORNERS * CELL
        up = blocks.heights[square.block, corner] - camera.y
        outline = widened(outline, turned(camera, east, up, north))
    return pixels_of(camera, outline)


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
            east, up, north = canvas.east[row, column], canvas.up[row, column], canvas.north[row, column]
            nearest, met = canvas.distance[row, column], canvas.met[row, column]
            is_in, distance = _meet_half(cell, cell.south_east, 1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            nearest, met = distance if nearer else nearest, cell.south_east.met if nearer else met
            is_in, distance = _meet_half(cell, cell.north_west, -1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            canvas.distance[row, column] = distance if nearer else nearest
            canvas.met[row, column] = cell.north_west.met if nearer else met


@kernel
def _paint_by_rows(cell: Cell, pixels: Rectangle, canvas: Canvas) -> None:
    """Do for whole rows what ``_paint`` does for a ray: several rays at once."""
    left, right = pixels.left, pixels.right
    for row in range(pixels.top, pixels.bottom):
        easts, ups = canvas.east[row, left:right], canvas.up[row, left:right]
        norths = canvas.north[row, left:right]
        distances, mets = canvas.distance[row, left:right], canvas.met[row, left:right]
        for ray in range(right - left):
            east, up, north = easts[ray], ups[ray], norths[ray]
            nearest, met = distances[ray], mets[ray]
            is_in, distance = _meet_half(cell, cell.south_east, 1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            nearest, met = distance if nearer else nearest, cell.south_east.met if nearer else met
            is_in, distance = _meet_half(cell, cell.north_west, -1.0, east, up, north)
            nearer = is_in & (distance < nearest)
            distances[ray] = distance if nearer else nearest
            mets[ray] = cell.north_west.met if nearer else met


@inlined_kernel
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
