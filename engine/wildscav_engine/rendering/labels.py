"""Labels of what each pixel shows: the kind of an object, or which one it is."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.dynamic_objects import ObjectArrays, ObjectSets, read_objects
from wildscav_engine.rendering.match_images import Matches, TracedImage, objects_in, trace_in_match
from wildscav_engine.rendering.trace import Scene, Scenes
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, is_terrain_code
from wildscav_engine.rendering.tracing.workspace import Size
from wildscav_engine.rendering.turns import TAKEN_ALREADY, item_at

FIRST_AGENT, FIRST_SOLID, FIRST_BOX = 10_000, 1_000_000, 1_000_000_000
NOTHING_LABEL, TERRAIN_LABEL, WATER_LABEL = int(Kind.NOTHING), int(Kind.TERRAIN), int(Kind.WATER)
AGENT = int(Kind.AGENT)


def write_labels(
    scenes: Scene | Scenes,
    objects: ObjectSets,
    matches: NDArray[np.int64],
    cameras: Cameras,
    images: NDArray[Any],
    turns: Turns = ALONE,
    *,
    by_instance: bool,
) -> bool:
    """Write the label of what each ray hits first, the surface of water included.

    Args:
        scenes: The static worlds of N cameras, or one for all.
        objects: The moving objects of some matches.
        matches: (N,) the match in ``objects`` that each camera is in.
        cameras: N cameras.
        images: (N, H, W) integers, written.
        turns: In which order to write them, with other threads.
        by_instance: Whether objects of one kind have labels of their own: solids of the map from FIRST_SOLID
            on by index, agents from FIRST_AGENT on by seat, boxes from FIRST_BOX on by serial number. All
            other labels are a ``Kind``.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    _, height, width = images.shape
    tables = scenes.tables(Size(height, width, cameras.half_width, objects.most_faces))
    return _write_labels(
        *cameras, tables, objects.addresses, objects.start, matches, *turns, by_instance, images
    )


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _write_labels(
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
    by_instance: bool,
    images: NDArray[Any],
) -> bool:
    """Implement ``write_labels``."""
    if not are_finite(eyes, yaws, pitches):
        return False
    cameras = Cameras(eyes, yaws, pitches, viewers, half_width, far)
    shown = Matches(workspaces, read_objects(objects), start, matches)
    count, height, width = images.shape
    for turn in range(count):
        image = item_at(Turns(order, taken), turn)
        if image == TAKEN_ALREADY:
            continue
        traced = trace_in_match(shown, cameras, image, height, width, True)
        first, _ = objects_in(shown, image)
        for row in range(height):
            _label_row(
                traced, shown.objects, first, by_instance, nonnegative(row * width), images[image, row]
            )
    return True


@inlined_kernel
def _label_row(
    traced: TracedImage, objects: ObjectArrays, first: int, by_instance: bool, start: int, line: NDArray[Any]
) -> None:
    """Write the labels of a row of pixels.

    Args:
        traced: The image.
        objects: The moving objects.
        first: The first of those in the match.
        by_instance: See ``write_labels``.
        start: The first ray of the row.
        line: (W,) written.
    """
    kinds, statics = traced.workspace.kinds, traced.solids.boxes.shape[0]
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
