"""The images of cameras in different matches: depths, normals, labels, or everything that rays hit.

One kernel makes them all: tracing is most of its code, and is compiled once.
"""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, are_finite, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectSets, read_objects, sets_of
from wildscav_engine.rendering.hits import Hits, write_hits
from wildscav_engine.rendering.labels import write_labels
from wildscav_engine.rendering.normals import write_normals
from wildscav_engine.rendering.trace import Matches, Scene, Scenes, objects_in, trace_in_match, write_depths
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
    _, height, width, *_ = images.shape
    size = Size(height, width, cameras.half_width, objects.most_faces)
    floats, kinds, numbers = NO_FLOATS, NO_KINDS, NO_NUMBERS
    if output is Output.KINDS:
        kinds = images
    elif output is Output.INSTANCES:
        numbers = images
    else:
        floats = images if output is Output.NORMALS else images[..., None]
    with_water = output in (Output.KINDS, Output.INSTANCES)
    arrays = (scenes.tables(size), objects.addresses, objects.start, matches, *turns)
    return _trace_images(output.value, with_water, *cameras, *arrays, floats, kinds, numbers, NO_NUMBERS)


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
    tables = scene.tables(Size(height, width, cameras.half_width, objects.most_faces))
    arrays = (tables, objects.addresses, objects.start, in_one_match, *ALONE)
    output = Output.HITS.value
    return _trace_images(output, with_water, *cameras, *arrays, distance[..., None], NO_KINDS, solid, face)


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _trace_images(
    output: int,
    with_water: bool,
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    viewers: NDArray[np.int32],
    half_width: float,
    far: float,
    workspaces: NDArray[np.int64],
    objects: Addresses,
    start: NDArray[np.int64],
    matches: NDArray[np.int64],
    order: NDArray[np.int64],
    taken: NDArray[np.int64],
    floats: NDArray[np.float32],
    kinds: NDArray[np.uint8],
    numbers: NDArray[np.int32],
    faces: NDArray[np.int32],
) -> bool:
    """Implement ``trace_images`` and ``trace``, which say what is in the arrays of each output."""
    if not are_finite(eyes, yaws, pitches):
        return False
    cameras = Cameras(eyes, yaws, pitches, viewers, half_width, far)
    shown = Matches(workspaces, read_objects(objects), start, matches)
    height = max(floats.shape[1], kinds.shape[1], numbers.shape[1])
    width = max(floats.shape[2], kinds.shape[2], numbers.shape[2])
    for turn in range(yaws.shape[0]):
        image = item_at(Turns(order, taken), turn)
        if image == TAKEN_ALREADY:
            continue
        traced = trace_in_match(shown, cameras, image, height, width, with_water)
        first, _ = objects_in(shown, image)
        if output == DEPTHS:
            write_depths(traced.buffer, floats[image].reshape(height, width))
        elif output == NORMALS:
            write_normals(traced, floats[image])
        elif output == KINDS:
            write_labels(traced, shown.objects, first, False, kinds[image])
        elif output == INSTANCES:
            write_labels(traced, shown.objects, first, True, numbers[image])
        else:
            write_hits(traced, Hits(floats[image].reshape(height, width), numbers[image], faces[image]))
    return True
