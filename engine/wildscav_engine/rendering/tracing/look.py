"""One image: all that there is, from near to far."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.kernel import array_kernel, inlined_kernel
from wildscav_engine.rendering.tracing.bodies import paint_solid
from wildscav_engine.rendering.tracing.canvas import Canvas, end_at_edges, fill, is_open, of_triangle
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, may_show, pixels_of_block
from wildscav_engine.rendering.tracing.packing import Blocks, Shapes
from wildscav_engine.rendering.tracing.terrain import (
    Sketch,
    Square,
    allocate_sketch,
    height_in,
    paint_terrain,
    paint_water,
)

SIDE = BLOCK * CELL  # m, of a block


class Desk(NamedTuple):
    """Room to work in."""

    sketch: Sketch
    outside: NDArray[np.float64]  # m that the eye is outside of each face of a solid
    blocks: NDArray[np.bool_]  # (B,) whether each may be on the image
    solids: NDArray[np.bool_]  # the same, of a block's members or of what moves
    members: NDArray[np.int64]  # of a block, those that may be on the image
    done: NDArray[np.int32]  # (S,) the last image that each solid of the scene was painted on


@array_kernel
def allocate_desk(blocks: Blocks, solids: Shapes, moving: Shapes) -> Desk:
    """Return room for the images of a scene."""
    return Desk(
        allocate_sketch(),
        np.empty(max(solids.most_faces, moving.most_faces)),
        np.empty(blocks.balls.shape[0], np.bool_),
        np.empty(max(solids.boxes.shape[0], moving.boxes.shape[0]), np.bool_),
        np.empty(solids.boxes.shape[0] + 1, np.int64),
        np.full(solids.boxes.shape[0], -1, np.int32),
    )


@inlined_kernel
def look(
    blocks: Blocks,
    solids: Shapes,
    moving: Shapes,
    camera: Camera,
    viewer: int,
    image: int,
    with_water: bool,
    desk: Desk,
    canvas: Canvas,
) -> None:
    """Let all rays of an image meet what there is.

    Args:
        blocks: The world.
        solids: In it.
        moving: In it besides; what the viewer owns is left out.
        camera: The image's.
        viewer: Whose eyes these are.
        image: Which image this is on the desk.
        with_water: Whether rays meet the surface of water.
        desk: Room to work in.
        canvas: The image, started.
    """
    row = int(np.floor((camera.z - blocks.edges[1]) / CELL))
    column = int(np.floor((camera.x - blocks.edges[0]) / CELL))
    if 0 <= row < blocks.rows and 0 <= column < blocks.columns:
        height, half = height_in(blocks, row, column, camera)
        if camera.y <= height:
            fill(canvas, 0.0, of_triangle(2 * (row * blocks.columns + column) + half))
            return
        _look_around(blocks, solids, row // BLOCK, column // BLOCK, camera, image, with_water, desk, canvas)
        if blocks.overhangs:
            west, south = blocks.edges[0], blocks.edges[1]
            end_at_edges(canvas, camera, west, south, blocks.columns * CELL, blocks.rows * CELL)
    _note_shown(moving.boxes, 0, moving.boxes.shape[0], camera, desk.solids)
    for solid in range(moving.boxes.shape[0]):
        if desk.solids[solid] and moving.names[solid] != viewer:
            paint_solid(moving, solid, solids.boxes.shape[0] + solid, camera, desk.outside, canvas)


@inlined_kernel
def _look_around(
    blocks: Blocks,
    solids: Shapes,
    row: int,
    column: int,
    camera: Camera,
    image: int,
    with_water: bool,
    desk: Desk,
    canvas: Canvas,
) -> None:
    """Paint the blocks around that of the eye, in rings from near to far."""
    rows, columns = (blocks.rows + BLOCK - 1) // BLOCK, (blocks.columns + BLOCK - 1) // BLOCK
    rings = int(camera.far / SIDE) + 1
    south, north = max(0, row - rings), min(rows - 1, row + rings)
    west, east = max(0, column - rings), min(columns - 1, column + rings)
    for r in range(south, north + 1):
        first = r * columns + west
        _note_shown(blocks.balls, first, first + east - west + 1, camera, desk.blocks[first:])
    whole = Rectangle(0, camera.width, 0, camera.height)
    for ring in range(rings + 1):
        # No block of this ring or beyond is nearer.
        if ring > 1 and not is_open(canvas, whole, (ring - 1) * SIDE):
            break
        for r in range(max(south, row - ring), min(north, row + ring) + 1):
            apart = 1 if abs(r - row) == ring else max(1, 2 * ring)
            for c in range(column - ring, column + ring + 1, apart):
                if west <= c <= east and desk.blocks[r * columns + c]:
                    _paint_block(blocks, solids, r, c, camera, image, with_water, desk, canvas)


@inlined_kernel
def _note_shown(
    balls: NDArray[np.float64], first: int, last: int, camera: Camera, shown: NDArray[np.bool_]
) -> None:
    """Note which of some balls (N, 4 and more) may be on the image."""
    for ball in range(first, last):
        shown[ball - first] = may_show(camera, balls[ball, 0], balls[ball, 1], balls[ball, 2], balls[ball, 3])


@inlined_kernel
def _paint_block(
    blocks: Blocks,
    solids: Shapes,
    row: int,
    column: int,
    camera: Camera,
    image: int,
    with_water: bool,
    desk: Desk,
    canvas: Canvas,
) -> None:
    block = row * ((blocks.columns + BLOCK - 1) // BLOCK) + column
    west, south = blocks.edges[0] + column * SIDE, blocks.edges[1] + row * SIDE
    square = Square(block, row * BLOCK, column * BLOCK, west - camera.x, south - camera.z)
    beside = max(0.0, square.east, -square.east - SIDE)
    beyond = max(0.0, square.north, -square.north - SIDE)
    nearest = np.sqrt(beside * beside + beyond * beyond)
    if nearest > camera.far:
        return
    for layer in range(2):
        low, high = blocks.balls[block, 4 + 2 * layer], blocks.balls[block, 5 + 2 * layer]
        if low <= high:
            pixels = pixels_of_block(camera, square.east, square.north, SIDE, low, high)
            if pixels.left < pixels.right and is_open(canvas, pixels, nearest):
                if layer == 0:
                    paint_terrain(blocks, square, camera, desk.sketch, canvas)
                else:
                    _paint_members(blocks, solids, block, camera, image, desk, canvas)
    if with_water:
        paint_water(blocks, square, camera, canvas)


@inlined_kernel
def _paint_members(
    blocks: Blocks, solids: Shapes, block: int, camera: Camera, image: int, desk: Desk, canvas: Canvas
) -> None:
    count = 0
    for item in range(blocks.member_start[block], blocks.member_start[block + 1]):
        solid = blocks.members[item]
        ball = solids.boxes[solid]
        # Written always, counted if shown: so nothing is to be guessed.
        desk.members[count] = solid
        is_shown = may_show(camera, ball[0], ball[1], ball[2], ball[3])
        count += is_shown & (desk.done[solid] != image)
    for member in range(count):
        solid = desk.members[member]
        desk.done[solid] = image
        paint_solid(solids, solid, solid, camera, desk.outside, canvas)
