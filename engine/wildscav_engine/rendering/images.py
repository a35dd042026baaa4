"""The images of cameras in different matches: depths, normals, labels, or everything that rays hit.

One kernel makes them all: tracing is most of its code, and is compiled once.
"""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, are_finite, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectSets, sets_of
from wildscav_engine.rendering.hits import Hits, write_hits
from wildscav_engine.rendering.labels import write_labels
from wildscav_engine.rendering.normals import write_normals
from wildscav_engine.rendering.trace import (
    Scene,
    Scenes,
    flatten_views,
    objects_in,
    read_views,
    trace_view,
    write_depths,
)
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
            labels, see ``labels.write_labels``; their rays hit water, all others go to its bed.
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
            write_normals(traced, floats[image])
        elif output == KINDS:
            write_labels(traced, matches.objects, first, False, kinds[image])
        elif output == INSTANCES:
            write_labels(traced, matches.objects, first, True, numbers[image])
        else:
            write_hits(traced, Hits(floats[image].reshape(height, width), numbers[image], faces[image]))
    return True
