"""The images of cameras in different matches: depths, normals, labels, or everything that rays hit.

One kernel makes them all: tracing is most of its code, and is compiled once.
"""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import BLOCK, CELL, Kind
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, are_finite, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectArrays, ObjectSets, sets_of
from wildscav_engine.rendering.hits import Hits, write_hits
from wildscav_engine.rendering.trace import (
    Scene,
    Scenes,
    TracedImage,
    flatten_views,
    objects_in,
    read_views,
    trace_view,
    write_depths,
)
from wildscav_engine.rendering.tracing.frustum import Camera, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, index_in_code, is_terrain_code
from wildscav_engine.rendering.tracing.scene_arrays import COLUMNS, CORNERS, Blocks, Shapes
from wildscav_engine.rendering.tracing.solid_intersection import write_entered_faces
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import Size


class Output(IntEnum):
    """What the kernel writes."""

    DEPTHS = 0
    NORMALS = 1
    KINDS = 2
    INSTANCES = 3
    HITS = 4


DEPTHS, NORMALS, KINDS, INSTANCES = map(int, (Output.DEPTHS, Output.NORMALS, Output.KINDS, Output.INSTANCES))
# The first labels of agents, of solids of the map, and of boxes, where each object has its own.
FIRST_AGENT, FIRST_SOLID, FIRST_BOX = 10_000, 1_000_000, 1_000_000_000
NOTHING_LABEL, TERRAIN_LABEL, WATER_LABEL = int(Kind.NOTHING), int(Kind.TERRAIN), int(Kind.WATER)
AGENT = int(Kind.AGENT)
# What an output does not have.
NO_FLOATS = np.zeros((0, 0, 0, 1), np.float32)
NO_KINDS = np.zeros((0, 0, 0), np.uint8)
NO_NUMBERS = np.zeros((0, 0, 0), np.int32)


def trace_images(
    output: Output,
    scenes: Scene | Scenes,
    objects: ObjectSets,
    matches: NDArray[np.int64],
    cameras: Cameras,
    images: NDArray[Any],
    turns: Turns = ALONE,
) -> bool:
    """Write an image of what each ray hits first.

    Args:
        output: ``DEPTHS``: (N, H, W) float32 m along the view axis, ``far`` without a hit. ``NORMALS``:
            (N, H, W, 3) float32, unit normals in the axes of the world, zeros where a ray hits nothing or
            starts below the ground or in a solid. ``KINDS`` and ``INSTANCES``: (N, H, W) uint8 and int32
            labels, see ``_write_labels``; their rays hit water, all others go to its bed.
        scenes: The static worlds of N cameras, or one for all.
        matches: (N,) the match in ``objects`` that each camera is in.
        cameras: N cameras. A camera outside the map sees nothing of it; one below the ground or in a solid
            hits that at distance 0.
        images: Written.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    number, with_water = int(output), True
    floats, kinds, numbers = NO_FLOATS, NO_KINDS, NO_NUMBERS
    if number == KINDS:
        kinds = images
    elif number == INSTANCES:
        numbers = images
    else:
        floats, with_water = images if number == NORMALS else images[..., None], False
    height, width = images.shape[1:3]
    size = Size(height, width, cameras.half_width, objects.most_faces)
    views = flatten_views(scenes, objects, matches, cameras, turns, size)
    return _trace_images(number, with_water, floats, kinds, numbers, NO_NUMBERS, *views)


def trace(scene: Scene, moving: Solids, cameras: Cameras, hits: Hits, *, with_water: bool = False) -> bool:
    """Find what each ray hits first.

    Args:
        with_water: Whether rays hit the surface of water; else they go to its bed.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    objects, in_one_match = sets_of(moving), np.zeros(len(cameras.yaws), np.int64)
    distance, solid, face = hits
    _, height, width = distance.shape
    size = Size(height, width, cameras.half_width, objects.most_faces)
    views = flatten_views(scene, objects, in_one_match, cameras, ALONE, size)
    return _trace_images(int(Output.HITS), with_water, distance[..., None], NO_KINDS, solid, face, *views)


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _trace_images(
    output: int,
    with_water: bool,
    floats: NDArray[np.float32],
    kinds: NDArray[np.uint8],
    numbers: NDArray[np.int32],
    faces: NDArray[np.int32],
    *views: Any,
) -> bool:
    """Implement ``trace_images`` and ``trace``, which say what is in the arrays of each output."""
    seen = read_views(views)
    matches, cameras = seen.matches, seen.cameras
    if not are_finite(cameras.eyes, cameras.yaws, cameras.pitches):
        return False
    height = max(floats.shape[1], kinds.shape[1], numbers.shape[1])
    width = max(floats.shape[2], kinds.shape[2], numbers.shape[2])
    for turn in range(cameras.yaws.shape[0]):
        image = item_at(seen.turns, turn)
        if image == TAKEN_ALREADY:
            continue
        traced = trace_view(seen, image, height, width, with_water)
        first, _ = objects_in(matches, image)
        if output == DEPTHS:
            write_depths(traced.buffer, floats[image].reshape(height, width))
        elif output == NORMALS:
            _write_normals(traced, floats[image])
        elif output == KINDS:
            _write_labels(traced, matches.objects, first, False, kinds[image])
        elif output == INSTANCES:
            _write_labels(traced, matches.objects, first, True, numbers[image])
        else:
            write_hits(traced, Hits(floats[image].reshape(height, width), numbers[image], faces[image]))
    return True


@inlined_kernel
def _write_labels(
    traced: TracedImage, objects: ObjectArrays, first: int, by_instance: bool, image: NDArray[Any]
) -> None:
    """Write the label of what each ray of an image hits, the surface of water included.

    Args:
        by_instance: Whether objects of one kind have labels of their own: solids of the map from FIRST_SOLID
            on by index, agents from FIRST_AGENT on by seat, boxes from FIRST_BOX on by serial number. All
            other labels are a ``Kind``.
        image: (H, W) integers, written.
    """
    kinds, statics = traced.workspace.blocks.kinds, traced.solids.obbs.shape[0]
    for row in range(image.shape[0]):
        line, start = image[row], nonnegative(row * image.shape[1])
        mets = traced.buffer.met[start : start + line.shape[0]]
        for column in range(line.shape[0]):
            met = mets[column]
            if met < NOTHING:
                line[column] = TERRAIN_LABEL if is_terrain_code(met) else WATER_LABEL
            elif met == NOTHING:
                line[column] = NOTHING_LABEL
            elif met < statics:
                line[column] = FIRST_SOLID + traced.solids.names[met] if by_instance else kinds[met]
            else:
                line[column] = _label_of_object(objects, first + met - statics, by_instance)


@inlined_kernel
def _label_of_object(objects: ObjectArrays, index: int, by_instance: bool) -> int:
    kind = objects.kind[index]
    if not by_instance:
        return int(kind)
    return int(objects.instance[index]) + (FIRST_AGENT if kind == AGENT else FIRST_BOX)


@inlined_kernel
def _write_normals(traced: TracedImage, image: NDArray[np.float32]) -> None:
    """Write (H, W, 3) unit normals; zeros where a ray hits nothing, or starts in the ground or a solid."""
    for row in range(image.shape[0]):
        _write_row(traced, traced.workspace.blocks, nonnegative(row * image.shape[1]), image[row])


@inlined_kernel
def _write_row(traced: TracedImage, blocks: Blocks, start: int, line: NDArray[np.float32]) -> None:
    """Write (W, 3) the normals of a row of pixels, the first of whose rays is ``start``."""
    statics, width, buffer = traced.solids.obbs.shape[0], line.shape[0], traced.buffer
    first = 0
    while first < width:
        met, last = buffer.met[start + first], first + 1
        while last < width and buffer.met[start + last] == met:
            last += 1
        part = line[first:last]
        if met < NOTHING:
            _fill(part, _normal_of_ground(blocks, index_in_code(met)))
        elif met == NOTHING:
            _fill(part, (0.0, 0.0, 0.0))
        elif met < statics:
            _write_solid(traced.solids, met, traced.camera, buffer, start + first, part)
        else:
            _write_solid(traced.moving, met - statics, traced.camera, buffer, start + first, part)
        for column in range(first, last):
            if buffer.distance[start + column] == 0.0:
                line[column, 0] = line[column, 1] = line[column, 2] = 0.0
        first = last


@inlined_kernel
def _write_solid(
    shapes: Shapes, solid: int, camera: Camera, buffer: HitBuffer, start: int, part: NDArray[np.float32]
) -> None:
    """Write (C, 3) the normals of the faces through which successive rays enter a solid."""
    # The codes of these rays are not needed anymore, so the faces take their place.
    faces = buffer.met[start : start + part.shape[0]]
    write_entered_faces(shapes, solid, camera, start, shapes.face_start[solid], buffer, faces)
    for column in range(part.shape[0]):
        normal = shapes.faces[faces[column]]
        part[column, 0], part[column, 1], part[column, 2] = normal[0], normal[1], normal[2]


@inlined_kernel
def _fill(part: NDArray[np.float32], normal: tuple[float, float, float]) -> None:
    for column in range(part.shape[0]):
        part[column, 0], part[column, 1], part[column, 2] = normal


@inlined_kernel
def _normal_of_ground(blocks: Blocks, triangle: int) -> tuple[float, float, float]:
    """Return the unit normal of a triangle of the terrain, numbered as in ``Hits``."""
    cell, half = triangle // 2, triangle % 2
    columns = blocks.extent[COLUMNS]
    row, column = cell // columns, cell % columns
    block = (row // BLOCK) * (-(-columns // BLOCK)) + column // BLOCK
    corner = (row % BLOCK) * CORNERS + column % BLOCK
    heights = blocks.heights[block]
    h00, h01 = heights[corner], heights[corner + 1]
    h10, h11 = heights[corner + CORNERS], heights[corner + CORNERS + 1]
    south_east = half == 0
    east = (h01 - h00 if south_east else h11 - h10) / CELL
    north = (h11 - h01 if south_east else h10 - h00) / CELL
    length = np.sqrt(east * east + 1.0 + north * north)
    return -east / length, 1.0 / length, -north / length
