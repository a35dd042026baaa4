"""Tracing one image: the blocks of the world from front to back, then the moving solids."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL
from wildscav_engine.rendering.tracing.coarse_projection import (
    PROJECTED_GROUP,
    Float32Camera,
    distance_at,
    is_near,
    is_shown,
    pixels_at,
    project_boxes,
    sphere_may_show,
    to_float32,
)
from wildscav_engine.rendering.tracing.frustum import (
    TOUCH,
    Camera,
    Rectangle,
    may_show,
    nonnegative,
    outline_of_box,
    pixels_of,
)
from wildscav_engine.rendering.tracing.hit_buffer import (
    HitBuffer,
    code_of_triangle,
    end_at_edges,
    fill,
    reaches_beyond,
)
from wildscav_engine.rendering.tracing.scene_arrays import (
    COLUMNS,
    GROUP,
    LANES,
    OVERHANGS,
    ROWS,
    Blocks,
    Shapes,
)
from wildscav_engine.rendering.tracing.solid_intersection import trace_solid
from wildscav_engine.rendering.tracing.terrain_intersection import (
    Square,
    allocate_projection,
    height_in,
    trace_terrain,
    trace_water,
)

SIDE = BLOCK * CELL  # m, of a block
GROUND, MEMBERS, WATER = range(3)  # the layers of a block, each with a span of heights


class Scratch(NamedTuple):
    """Scratch buffers for tracing an image."""

    projection: NDArray[np.float32]  # see ``trace_terrain``
    boxes: NDArray[np.float32]  # (3, GROUP) the grounds of eight blocks, their members, and their waters
    projected: NDArray[np.float32]  # (4, PROJECTED_GROUP) the same projected, and eight members
    planes: NDArray[np.float64]  # (F, 4) the faces of a solid
    shown: NDArray[np.float32]  # (B + 8,) 1 if a block of a row may be visible, else 0
    # (4, B) rows and columns of the blocks that may be visible; then the same from near to far
    queue: NDArray[np.int64]
    rings: NDArray[np.int64]  # (B + 2,) where the blocks of each ring around the eye start in that order
    cells: NDArray[np.int64]  # (65,) the cells of a block that may be visible
    # (1 + S,) the number of images so far; the last image that each solid was traced in
    done: NDArray[np.int64]


def allocate_scratch(blocks: int, solids: int, most_faces: int) -> Scratch:
    """Return scratch buffers for the images of a scene with these numbers of blocks and solids."""
    boxes = np.zeros((3, GROUP), np.float32)
    # All blocks have the same half edges: half a side to the east, and half a side to the north.
    boxes[:, 4 * LANES : 5 * LANES] = boxes[:, 7 * LANES : 8 * LANES] = SIDE / 2
    return Scratch(
        allocate_projection(),
        boxes,
        np.zeros((4, PROJECTED_GROUP), np.float32),
        np.empty((most_faces, 4)),
        np.empty(blocks + LANES, np.float32),
        np.empty((4, blocks + 1), np.int64),
        np.empty(blocks + 2, np.int64),
        np.empty(BLOCK * BLOCK + 1, np.int64),
        np.zeros(1 + solids, np.int64),
    )


@kernel
def trace_moving_solids(
    moving: Shapes, others: int, camera: Camera, viewer: int, planes: NDArray[np.float64], buffer: HitBuffer
) -> None:
    """Intersect the rays of an image with the moving solids but those that the viewer owns.

    They are counted after ``others``, the solids of the world; ``planes`` is as in ``trace_solid``.
    """
    for solid in range(moving.obbs.shape[0]):
        box = moving.obbs[solid]
        if moving.names[solid] != viewer and may_show(camera, box[0], box[1], box[2], box[3]):
            outline = outline_of_box(camera, box)
            pixels = pixels_of(camera, outline)
            # The distance along a ray is never less than the depth ahead.
            if pixels.left < pixels.right and reaches_beyond(buffer, pixels, outline.nearest):
                trace_solid(moving, solid, others + solid, pixels, camera, planes, buffer)


@kernel
def trace_world(
    blocks: Blocks, solids: Shapes, camera: Camera, with_water: bool, scratch: Scratch, buffer: HitBuffer
) -> None:
    """Intersect the rays of an image with the static world."""
    row = int(np.floor((camera.z - blocks.edges[1]) / CELL))
    column = int(np.floor((camera.x - blocks.edges[0]) / CELL))
    if not (0 <= row < blocks.extent[ROWS] and 0 <= column < blocks.extent[COLUMNS]):
        return
    height, half = height_in(blocks, row, column, camera)
    if camera.y <= height:
        fill(buffer, 0.0, code_of_triangle(2 * (row * blocks.extent[COLUMNS] + column) + half))
        return
    _trace_blocks(blocks, solids, row // BLOCK, column // BLOCK, camera, with_water, scratch, buffer)
    if blocks.extent[OVERHANGS]:
        west, south = blocks.edges[0], blocks.edges[1]
        width, height = blocks.extent[COLUMNS] * CELL, blocks.extent[ROWS] * CELL
        end_at_edges(buffer, camera, west, south, width, height)


@inlined_kernel
def _trace_blocks(
    blocks: Blocks,
    solids: Shapes,
    row: int,
    column: int,
    camera: Camera,
    with_water: bool,
    scratch: Scratch,
    buffer: HitBuffer,
) -> None:
    """Trace the blocks around the eye, in rings from near to far."""
    scratch.done[0] += 1
    camera32 = to_float32(camera)
    count = _queue_blocks(blocks, row, column, camera, camera32, scratch)
    whole, ring = Rectangle(0, camera.width, 0, camera.height), 0
    for item in range(count):
        if item % LANES == 0:
            some = min(LANES, count - item)
            _place_blocks(blocks, item, some, WATER + with_water, camera, camera32, scratch)
        r, c = scratch.queue[2, item], scratch.queue[3, item]
        apart = max(abs(r - row), abs(c - column))
        if apart > max(ring, 1) and not reaches_beyond(buffer, whole, (apart - 1) * SIDE):
            # No block of this ring or beyond is near enough.
            break
        ring = apart
        square = _square_at(blocks, r, c, camera)
        nearest = _distance_to(square)
        if nearest > camera.far:
            continue
        ground = _pixels_of_layer(nearest, GROUND, item % LANES, camera, scratch, buffer)
        if ground.left < ground.right:
            may_be_near = is_near(scratch.projected[GROUND], item % LANES)
            trace_terrain(blocks, square, may_be_near, camera, camera32, scratch.projection, buffer)
        members = _pixels_of_layer(nearest, MEMBERS, item % LANES, camera, scratch, buffer)
        if members.left < members.right:
            _trace_members(blocks, solids, square, camera, camera32, scratch, buffer)
        if with_water:
            water = _pixels_of_layer(nearest, WATER, item % LANES, camera, scratch, buffer)
            if water.left < water.right:
                trace_water(blocks, square, camera, buffer)


@inlined_kernel
def _square_at(blocks: Blocks, row: int, column: int, camera: Camera) -> Square:
    block = nonnegative(row * ((blocks.extent[COLUMNS] + BLOCK - 1) // BLOCK) + column)
    west, south = blocks.edges[0] + column * SIDE, blocks.edges[1] + row * SIDE
    return Square(block, row * BLOCK, column * BLOCK, west - camera.x, south - camera.z)


@kernel
def _queue_blocks(
    blocks: Blocks, row: int, column: int, camera: Camera, camera32: Float32Camera, scratch: Scratch
) -> int:
    """List the blocks that may be visible, from near to far, and return how many there are."""
    rows = (blocks.extent[ROWS] + BLOCK - 1) // BLOCK
    columns = (blocks.extent[COLUMNS] + BLOCK - 1) // BLOCK
    rings = min(int(camera.far / SIDE) + 1, max(rows, columns))
    ahead = camera.cos_pitch
    goes_south, goes_north = _ways(camera, camera.cos_yaw * ahead, camera.cos_yaw, camera.sin_yaw)
    goes_west, goes_east = _ways(camera, camera.sin_yaw * ahead, camera.sin_yaw, camera.cos_yaw)
    south = max(0, row - rings) if goes_south else row
    north = min(rows - 1, row + rings) if goes_north else row
    west = max(0, column - rings) if goes_west else column
    east = min(columns - 1, column + rings) if goes_east else column
    scratch.rings[: rings + 2] = 0
    count = 0
    for r in range(south, north + 1):
        first = r * columns + west
        last = first + (east - west + LANES) // LANES * LANES  # whole vectors
        _note_shown(
            blocks.middles[first:last],
            blocks.radii[first:last],
            _square_at(blocks, r, west, camera),
            camera.y,
            camera32,
            scratch.shown,
        )
        for c in range(west, east + 1):
            # Always written, counted only if visible: this avoids branches.
            place = nonnegative(count)
            scratch.queue[0, place], scratch.queue[1, place] = r, c
            is_one = int(scratch.shown[nonnegative(c - west)])
            scratch.rings[nonnegative(max(abs(r - row), abs(c - column))) + 1] += is_one
            count += is_one
    for ring in range(rings + 1):
        scratch.rings[ring + 1] += scratch.rings[ring]
    for item in range(count):
        r, c = scratch.queue[0, item], scratch.queue[1, item]
        ring = nonnegative(max(abs(r - row), abs(c - column)))
        place = nonnegative(scratch.rings[ring])
        scratch.queue[2, place], scratch.queue[3, place] = r, c
        scratch.rings[ring] = place + 1
    return count


@inlined_kernel
def _ways(camera: Camera, ahead: float, above: float, right: float) -> tuple[bool, bool]:
    """Return whether any ray of a camera may go down along an axis of the map, and whether any may go up.

    ``ahead`` is the component of the view axis along it. Per unit of tangent, rays differ from that by
    ``above``, times the sine of the pitch, and by ``right``, whose sign does not count.
    """
    give = abs(above * camera.sin_pitch) * camera.half_height + abs(right) * camera.half_width
    return ahead - give < TOUCH, ahead + give > -TOUCH


@inlined_kernel
def _note_shown(
    middles: NDArray[np.float32],
    radii: NDArray[np.float32],
    square: Square,
    height: float,
    camera: Float32Camera,
    shown: NDArray[np.float32],
) -> None:
    """Write 1 for the blocks of a row that may be visible, else 0, given the height of the camera in m.

    ``middles`` and ``radii`` are those in ``Blocks``; ``square`` is the first block.
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
        shown[block] = np.float32(sphere_may_show(camera, right, above, ahead, radii[block]))


@kernel
def _place_blocks(
    blocks: Blocks,
    first: int,
    count: int,
    layers: int,
    camera: Camera,
    camera32: Float32Camera,
    scratch: Scratch,
) -> None:
    """Project the first layers of up to eight blocks of the queue onto the image."""
    height = np.float32(camera.y)
    for lane in range(count):
        square = _square_at(blocks, scratch.queue[2, first + lane], scratch.queue[3, first + lane], camera)
        east, north = np.float32(square.east + SIDE / 2), np.float32(square.north + SIDE / 2)
        block = blocks.layers[square.block]
        for layer in range(layers):
            boxes = scratch.boxes[layer]
            boxes[lane], boxes[2 * LANES + lane] = east, north
            boxes[LANES + lane] = block[3 * layer] - height
            boxes[3 * LANES + lane], boxes[8 * LANES + lane] = block[3 * layer + 1], block[3 * layer + 2]
    zero = np.float32(0.0)
    for layer in range(layers):
        project_boxes(zero, zero, zero, camera32, scratch.boxes[layer], scratch.projected[layer])


@inlined_kernel
def _distance_to(square: Square) -> float:
    """Return how far away the nearest point of a block is, in m on the level."""
    east, north = max(0.0, square.east, -square.east - SIDE), max(0.0, square.north, -square.north - SIDE)
    return float(np.sqrt(east * east + north * north))


@inlined_kernel
def _pixels_of_layer(
    nearest: float, layer: int, lane: int, camera: Camera, scratch: Scratch, buffer: HitBuffer
) -> Rectangle:
    """Return the pixels that a layer of a block may cover; none if all have hits nearer than the block."""
    none, projected = Rectangle(0, 0, 0, 0), scratch.projected[layer]
    if not is_shown(projected, lane):
        return none
    whole = Rectangle(0, camera.width, 0, camera.height)
    pixels = whole if is_near(projected, lane) else pixels_at(projected, lane)
    return pixels if reaches_beyond(buffer, pixels, nearest) else none


@kernel
def _trace_members(
    blocks: Blocks,
    solids: Shapes,
    square: Square,
    camera: Camera,
    camera32: Float32Camera,
    scratch: Scratch,
    buffer: HitBuffer,
) -> None:
    """Trace the solids that reach into a block."""
    boxes, image = scratch.projected[WATER + 1], scratch.done[0]
    east, north = np.float32(square.east), np.float32(square.north)
    up = np.float32(blocks.lowest[square.block] - camera.y)
    first, last = blocks.group_start[square.block], blocks.group_start[square.block + 1]
    for group in range(nonnegative(first), nonnegative(last)):
        project_boxes(east, up, north, camera32, blocks.groups[group], boxes)
        count = 0
        for lane in range(LANES):
            scratch.cells[nonnegative(count)] = lane
            solid = nonnegative(blocks.members[nonnegative(LANES * group) + lane])
            count += is_shown(boxes, lane) & (scratch.done[1 + solid] != image)
        for item in range(count):
            lane = nonnegative(scratch.cells[item])
            solid = nonnegative(blocks.members[nonnegative(LANES * group) + lane])
            scratch.done[1 + solid] = image
            pixels, nearest = pixels_at(boxes, lane), distance_at(boxes, lane)
            if is_near(boxes, lane):
                outline = outline_of_box(camera, solids.obbs[solid])
                pixels, nearest = pixels_of(camera, outline), outline.nearest
            if pixels.left < pixels.right and reaches_beyond(buffer, pixels, nearest):
                trace_solid(solids, solid, solid, pixels, camera, scratch.planes, buffer)
