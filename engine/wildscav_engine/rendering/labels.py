"""Labels of what each pixel shows."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.trace import pack_moving, trace_camera, workspace_for
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, hit_buffer_in, is_terrain_code
from wildscav_engine.rendering.tracing.packing import Shapes, unpack_shapes
from wildscav_engine.rendering.tracing.scene import Scene
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.rendering.tracing.workspace import read_workspace

NOTHING_LABEL, TERRAIN_LABEL, WATER_LABEL = int(Kind.NOTHING), int(Kind.TERRAIN), int(Kind.WATER)


def write_labels(
    scene: Scene,
    moving: Solids,
    cameras: Cameras,
    labels: NDArray[Any],
    moving_labels: NDArray[Any],
    images: NDArray[Any],
) -> bool:
    """Write the label of what each ray hits first, the surface of water included.

    Args:
        scene: The static world, with S solids.
        moving: The M moving solids.
        cameras: N cameras.
        labels: (S,) integers, of the world's solids; those of nothing, terrain and water are their ``Kind``.
        moving_labels: (M,) integers.
        images: (N, H, W) integers, written.

    Returns:
        Whether all numbers of the cameras are finite; if not, nothing is written.
    """
    others = pack_moving(moving)
    _, height, width = images.shape
    workspace = workspace_for(scene, height, width, cameras.half_width, others).addresses
    return _write_labels(*cameras, others.numbers, others.indices, workspace, labels, moving_labels, images)


# Arrays are passed to this kernel one by one, for the reason given in ``trace.py``.
@kernel
def _write_labels(
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    viewers: NDArray[np.int32],
    half_width: float,
    far: float,
    moving_numbers: NDArray[np.float64],
    moving_indices: NDArray[np.int64],
    workspace: Addresses,
    labels: NDArray[Any],
    moving_labels: NDArray[Any],
    images: NDArray[Any],
) -> bool:
    """Implement ``write_labels``."""
    if not are_finite(eyes, yaws, pitches):
        return False
    parts, others = read_workspace(workspace), unpack_shapes(moving_numbers, moving_indices)
    solids = unpack_shapes(parts.numbers, parts.indices)
    _, height, width = images.shape
    cameras = Cameras(eyes, yaws, pitches, viewers, half_width, far)
    buffer = hit_buffer_in(width, parts.rays, parts.met, parts.strips)
    for image in range(images.shape[0]):
        trace_camera(parts, others, cameras, image, height, True, buffer)
        for row in range(height):
            start, line = nonnegative(row * width), images[image, row]
            _label_row(solids, buffer.met[start : start + width], labels, moving_labels, line)
    return True


@inlined_kernel
def _label_row(
    solids: Shapes,
    mets: NDArray[np.int32],
    labels: NDArray[Any],
    moving_labels: NDArray[Any],
    line: NDArray[Any],
) -> None:
    """Write the labels of what the rays of a row hit, given its codes."""
    statics = solids.boxes.shape[0]
    for column in range(mets.shape[0]):
        met = mets[column]
        if met < NOTHING:
            line[column] = TERRAIN_LABEL if is_terrain_code(met) else WATER_LABEL
        elif met == NOTHING:
            line[column] = NOTHING_LABEL
        elif met < statics:
            line[column] = labels[solids.names[met]]
        else:
            line[column] = moving_labels[met - statics]
