"""Depth maps that show what moves in matches."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.dynamic_objects import ObjectSets, read_objects
from wildscav_engine.rendering.match_images import Matches, trace_in_match
from wildscav_engine.rendering.trace import Scene, Scenes, write_depths
from wildscav_engine.rendering.tracing.workspace import Size
from wildscav_engine.rendering.turns import TAKEN_ALREADY, item_at


def trace_depths(
    scenes: Scene | Scenes,
    objects: ObjectSets,
    matches: NDArray[np.int64],
    cameras: Cameras,
    depths: NDArray[np.float32],
    turns: Turns = ALONE,
) -> bool:
    """Find the depth of each ray's first hit along the view axis.

    Args:
        scenes: The static worlds of N cameras, or one for all.
        objects: The moving objects of some matches.
        matches: (N,) the match in ``objects`` that each camera is in.
        cameras: N cameras. A camera outside the map sees nothing of it; one below the ground or in a solid
            hits that at distance 0.
        depths: (N, H, W) m, written: the cameras' ``far`` without a hit.
        turns: In which order to write them, with other threads.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    _, height, width = depths.shape
    tables = scenes.tables(Size(height, width, cameras.half_width, objects.most_faces))
    return _trace_depths(*cameras, tables, objects.addresses, objects.start, matches, *turns, depths)


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _trace_depths(
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
    depths: NDArray[np.float32],
) -> bool:
    """Implement ``trace_depths``."""
    if not are_finite(eyes, yaws, pitches):
        return False
    cameras = Cameras(eyes, yaws, pitches, viewers, half_width, far)
    shown = Matches(workspaces, read_objects(objects), start, matches)
    count, height, width = depths.shape
    for turn in range(count):
        image = item_at(Turns(order, taken), turn)
        if image == TAKEN_ALREADY:
            continue
        traced = trace_in_match(shown, cameras, image, height, width, False)
        write_depths(traced.buffer, depths[image])
    return True
