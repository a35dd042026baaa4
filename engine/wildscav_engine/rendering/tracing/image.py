"""One image: all that there is, from near to far."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.tracing.bodies import paint_solid
from wildscav_engine.rendering.tracing.canvas import Canvas, end_at_edges, fill, is_open, of_triangle
from wildscav_engine.rendering.tracing.frustum import (
    Camera,
    Rectangle,
    may_show,
    natural,
    outline_of_box,
    pixels_of,
    pixels_of_block,
)
from wildscav_engine.rendering.tracing.packing import GROUP, LANES, Blocks, Shapes
from wildscav_engine.rendering.tracing.rough import (
    NEVER_SEEN,
    ROOM,
    RoughCamera,
    ball_shows,
    distance_at,
    is_near,
    is_shown,
    pixels_at,
    place_boxes,
    roughly,
)
from wildscav_engine.rendering.tracing.terrain import (
    Square,
    allocate_sketch,
    height_in,
    paint_terrain,
    paint_water,
)

SIDE = BLOCK * CELL  # m, of a block


class Desk(NamedTuple):
    """Room to work in."""

    sketch: NDArray[np.float32]  # see ``paint_terrain``
    boxes: NDArray[np.float32]  # (3, ROOM) of eight blocks: their grounds and their members; of eight members
    outside: NDArray[np.float64]  # m that the eye is outside of each face of a solid
    shown: NDArray[np.float32]  # (B,) 1 if a block of a row may be on the image, else 0
    queue: NDArray[np.int64]  # (4, B) rows and columns of blocks that may be; the same from near to far
    rings: NDArray[np.int64]  # (B + 2,) where in that order the blocks of each ring around the eye start
    cells: NDArray[np.int64]  # (65,) of a block, those that may be on the image
    done: NDArray[np.int64]  # (1 + S,) how many images were made; the last that each solid was painted on


def allocate_desk(blocks: int, solids: int, most_faces: int) -> Desk:
    """Return room for the images of a scene with so many blocks and solids."""
    boxes = np.zeros((3, ROOM), np.float32)
    # Blocks are all alike: half a side to the east, and half a side to the north.
    boxes[:2, 4 * LANES : 5 * LANES] = boxes[:2, 7 * LANES : 8 * LANES] = SIDE / 2
    return Desk(
        allocate_sketch(),
        boxes,
        np.empty(most_faces),
        np.empty(blocks, np.float32),
        np.empty((4, blocks + 1), np.int64),
        np.empty(blocks + 2, np.int64),
        np.empty(BLOCK * BLOCK + 1, np.int64),
        np.zeros(1 + solids, np.int64),
    )


@kernel
def look_at_things(
    moving: Shapes, others: int, camera: Camera, viewer: int, outside: NDArray[np.float64], canvas: Canvas
) -> None:
    """Let all rays of an image meet what moves.

    Args:
        moving: All that does; what the viewer owns is left out.
        others: How many solids there are besides, which are counted before these.
        camera: The image's.
        viewer: Whose eyes these are.
        outside: Room for as many numbers as a solid has faces.
        canvas: The image, started.
    """
    for solid in range(moving.boxes.shape[0]):
        box = moving.boxes[solid]
        if moving.names[solid] != viewer and may_show(camera, box[0], box[1], box[2], box[3]):
            outline = outline_of_box(camera, box)
            pixels = pixels_of(camera, outline)
            # No ray is shorter than the way ahead of what it meets.
            if pixels.left < pixels.right and is_open(canvas, pixels, outline.nearest):
                paint_solid(moving, solid, others + solid, pixels, camera, outside, canvas)


@kernel
def look_at_world(
    blocks: Blocks, solids: Shapes, camera: Camera, with_water: bool, desk: Desk, canvas: Canvas
) -> None:
    """Let all rays of an image meet what stands still.

    Args:
        blocks: The world.
        solids: In it.
        camera: The image's.
        with_water: Whether rays meet the surface of water.
        desk: Room to work in.
        canvas: The image, started.
    """
    row = int(np.floor((camera.z - blocks.edges[1]) / CELL))
    column = int(np.floor((camera.x - blocks.edges[0]) / CELL))
    if not (0 <= row < blocks.rows and 0 <= column < blocks.columns):
        return
    height, half = height_in(blocks, row, column, camera)
    if camera.y <= height:
        fill(canvas, 0.0, of_triangle(2 * (row * blocks.columns + column) + half))
        return
    _look_around(blocks, solids, row // BLOCK, column // BLOCK, camera, with_water, desk, canvas)
    if blocks.overhangs:
        west, south = blocks.edges[0], blocks.edges[1]
        end_at_edges(canvas, camera, west, south, blocks.columns * CELL, blocks.rows * CELL)


@inlined_kernel
def _look_around(
    blocks: Blocks,
    solids: Shapes,
    row: int,
    column: int,
    camera: Camera,
    with_water: bool,
    desk: Desk,
    canvas: Canvas,
) -> None:
    """Paint the blocks around that of the eye, in rings from near to far."""
    desk.done[0] += 1
    rough = roughly(camera)
    count = _queue_blocks(blocks, row, column, camera, rough, desk)
    whole, ring = Rectangle(0, camera.width, 0, camera.height), 0
    for item in range(count):
        if item % LANES == 0:
            _place_blocks(blocks, item, min(LANES, count - item), camera, rough, desk)
        r, c = desk.queue[2, item], desk.queue[3, item]
        apart = max(abs(r - row), abs(c - column))
        if apart > max(ring, 1) and not is_open(canvas, whole, (apart - 1) * SIDE):
            # No block of this ring or beyond is nearer.
            break
        ring = apart
        square = _square_at(blocks, r, c, camera)
        ground = _pixels_of_layer(blocks, square, 0, item % LANES, camera, desk, canvas)
        if ground.left < ground.right:
            paint_terrain(blocks, square, camera, rough, desk.sketch, desk.cells, canvas)
        members = _pixels_of_layer(blocks, square, 1, item % LANES, camera, desk, canvas)
        if members.left < members.right:
            _paint_members(blocks, solids, square, camera, rough, desk, canvas)
        if with_water:
            paint_water(blocks, square, camera, canvas)


@inlined_kernel
def _square_at(blocks: Blocks, row: int, column: int, camera: Camera) -> Square:
    block = natural(row * ((blocks.columns + BLOCK - 1) // BLOCK) + column)
    west, south = blocks.edges[0] + column * SIDE, blocks.edges[1] + row * SIDE
    return Square(block, row * BLOCK, column * BLOCK, west - camera.x, south - camera.z)


@kernel
def _queue_blocks(
    blocks: Blocks, row: int, column: int, camera: Camera, rough: RoughCamera, desk: Desk
) -> int:
    """List the blocks that may be on the image, from near to far, and return how many they are.

    Args:
        blocks: The world.
        row: Of the block that the eye is in.
        column: Likewise.
        camera: The image's.
        rough: The same.
        desk: Its queue is written.
    """
    rows, columns = (blocks.rows + BLOCK - 1) // BLOCK, (blocks.columns + BLOCK - 1) // BLOCK
    rings = min(int(camera.far / SIDE) + 1, max(rows, columns))
    south, north = max(0, row - rings), min(rows - 1, row + rings)
    west, east = max(0, column - rings), min(columns - 1, column + rings)
    desk.rings[: rings + 2] = 0
    count = 0
    for r in range(south, north + 1):
        first = r * columns + west
        last = first + east - west + 1
        _note_shown(
            blocks.middles[first:last],
            blocks.radii[first:last],
            _square_at(blocks, r, west, camera),
            camera.y,
            rough,
            desk.shown,
        )
        for c in range(west, east + 1):
            # Written always, counted if shown: so nothing is to be guessed.
            place = natural(count)
            desk.queue[0, place], desk.queue[1, place] = r, c
            is_one = int(desk.shown[natural(c - west)])
            desk.rings[natural(max(abs(r - row), abs(c - column))) + 1] += is_one
            count += is_one
    for ring in range(rings + 1):
        desk.rings[ring + 1] += desk.rings[ring]
    for item in range(count):
        r, c = desk.queue[0, item], desk.queue[1, item]
        ring = natural(max(abs(r - row), abs(c - column)))
        place = natural(desk.rings[ring])
        desk.queue[2, place], desk.queue[3, place] = r, c
        desk.rings[ring] = place + 1
    return count


@inlined_kernel
def _note_shown(
    middles: NDArray[np.float32],
    radii: NDArray[np.float32],
    square: Square,
    height: float,
    camera: RoughCamera,
    shown: NDArray[np.float32],
) -> None:
    """Note which blocks of a row may be on the image.

    Args:
        middles: (N,) m, how high the middles of the blocks are.
        radii: (N,) m, of balls around what is in them.
        square: The westernmost.
        height: m, the camera's.
        camera: The image's.
        shown: (N,) written: 1 for those that may be.
    """
    side = np.float32(SIDE)
    east, north, y = (
        np.float32(square.east + SIDE / 2),
        np.float32(square.north + SIDE / 2),
        np.float32(height),
    )
    for block in range(middles.shape[0]):
        x, up = east + side * np.float32(block), middles[block] - y
        level = camera.sin_yaw * x + camera.cos_yaw * north
        right = camera.cos_yaw * x - camera.sin_yaw * north
        above = camera.cos_pitch * up + camera.sin_pitch * level
        ahead = camera.cos_pitch * level - camera.sin_pitch * up
        shown[block] = np.float32(ball_shows(camera, right, above, ahead, radii[block]))


@kernel
def _place_blocks(
    blocks: Blocks, first: int, count: int, camera: Camera, rough: RoughCamera, desk: Desk
) -> None:
    """Find where the grounds and the members of up to eight blocks of the queue lie on the image."""
    for lane in range(count):
        square = _square_at(blocks, desk.queue[2, first + lane], desk.queue[3, first + lane], camera)
        for layer in range(2):
            boxes = desk.boxes[layer]
            low, high = blocks.spans[square.block, 2 * layer], blocks.spans[square.block, 2 * layer + 1]
            has_any = low <= high
            half = 0.5 * (high - low) if has_any else 0.0
            boxes[lane] = square.east + SIDE / 2
            boxes[LANES + lane] = 0.5 * (low + high) - camera.y if has_any else 0.0
            boxes[2 * LANES + lane] = square.north + SIDE / 2
            boxes[3 * LANES + lane] = half
            boxes[8 * LANES + lane] = np.sqrt(0.5 * SIDE * SIDE + half * half) if has_any else NEVER_SEEN
    zero = np.float32(0.0)
    for layer in range(2):
        place_boxes(zero, zero, zero, rough, desk.boxes[layer])


@inlined_kernel
def _pixels_of_layer(
    blocks: Blocks, square: Square, layer: int, lane: int, camera: Camera, desk: Desk, canvas: Canvas
) -> Rectangle:
    """Return the pixels that the ground (0) or the members (1) of a block can lie on, if any are left."""
    none = Rectangle(0, 0, 0, 0)
    if not is_shown(desk.boxes[layer], lane):
        return none
    pixels = pixels_at(desk.boxes[layer], lane)
    if is_near(desk.boxes[layer], lane):
        low, high = blocks.spans[square.block, 2 * layer], blocks.spans[square.block, 2 * layer + 1]
        pixels = pixels_of_block(camera, square.east, square.north, SIDE, low, high)
    east, north = max(0.0, square.east, -square.east - SIDE), max(0.0, square.north, -square.north - SIDE)
    nearest = np.sqrt(east * east + north * north)
    return pixels if nearest <= camera.far and is_open(canvas, pixels, nearest) else none


@kernel
def _paint_members(
    blocks: Blocks,
    solids: Shapes,
    square: Square,
    camera: Camera,
    rough: RoughCamera,
    desk: Desk,
    canvas: Canvas,
) -> None:
    """Paint what stands in a block."""
    boxes, image = desk.boxes[2], desk.done[0]
    east, north = np.float32(square.east), np.float32(square.north)
    up = np.float32(blocks.spans[square.block, 0] - camera.y)
    first, last = blocks.group_start[square.block], blocks.group_start[square.block + 1]
    for group in range(natural(first), natural(last)):
        for number in range(GROUP):
            boxes[number] = blocks.groups[group, number]
        place_boxes(east, up, north, rough, boxes)
        count = 0
        for lane in range(LANES):
            desk.cells[natural(count)] = lane
            solid = natural(blocks.members[natural(LANES * group) + lane])
            count += is_shown(boxes, lane) & (desk.done[1 + solid] != image)
        for item in range(count):
            lane = natural(desk.cells[item])
            solid = natural(blocks.members[natural(LANES * group) + lane])
            desk.done[1 + solid] = image
            pixels, nearest = pixels_at(boxes, lane), distance_at(boxes, lane)
            if is_near(boxes, lane):
                outline = outline_of_box(camera, solids.boxes[solid])
                pixels, nearest = pixels_of(camera, outline), outline.nearest
            if pixels.left < pixels.right and is_open(canvas, pixels, nearest):
                paint_solid(solids, solid, solid, pixels, camera, desk.outside, canvas)
