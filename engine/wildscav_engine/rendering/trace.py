"""Ray tracing for cameras: what the ray of each pixel hits first.

All rays of an image start at one eye, so an image is traced object by object instead of ray by ray. Blocks of
cells are visited from near to far. In each block, the cells and solids that may be visible are projected onto
the image, and only the rays of the pixels they cover are intersected with them. Objects that cannot be nearer
than the hits found so far are skipped. The result of a ray is the nearest of the same intersections, computed
in the same way, whichever image the ray belongs to.
"""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel, only_for
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.tracing.front_to_back import Scratch, trace_moving_solids, trace_world
from wildscav_engine.rendering.tracing.frustum import Camera, camera_at
from wildscav_engine.rendering.tracing.hit_buffer import (
    NOTHING,
    HitBuffer,
    aim_rays,
    hit_buffer_in,
)
from wildscav_engine.rendering.tracing.packing import Shapes, unpack_blocks, unpack_shapes
from wildscav_engine.rendering.tracing.scene import Scene, Scenes, scene_of
from wildscav_engine.rendering.tracing.workspace import Size, Workspace, read_workspace
from wildscav_engine.rendering.turns import TAKEN_ALREADY, item_at

__all__ = [
    "Scene",
    "Scenes",
    "depths_tracer",
    "scene_of",
    "trace_static_depths",
]


def trace_static_depths(
    scenes: Scene | Scenes, size: Size, cameras: Cameras, depths: NDArray[np.float32], turns: Turns = ALONE
) -> bool:
    """Do the same as ``depths.trace_depths``, faster, where nothing moves.

    Args:
        scenes: The worlds of N cameras, or one for all.
        size: The size of the images, and their half width.
        depths: (N, H, W) m, written.
    """
    eyes, yaws, pitches, _, half_width, far = cameras
    return _trace_static_depths(eyes, yaws, pitches, half_width, far, scenes.tables(size), *turns, depths)


# These kernels take everything that stays the same between calls through a table of addresses, and all other
# arrays one by one: passing a tuple of arrays from Python takes several times longer.


@kernel
def _trace_static_depths(
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    half_width: float,
    far: float,
    workspaces: NDArray[np.int64],
    order: NDArray[np.int64],
    taken: NDArray[np.int64],
    depths: NDArray[np.float32],
) -> bool:
    """Implement ``trace_static_depths``.

    It also returns False for shapes that do not match, so that callers in a hot loop need not check them.
    """
    count, height, width = depths.shape
    is_whole = eyes.shape[0] == yaws.shape[0] == pitches.shape[0] == count and eyes.shape[1] == 3
    if not (is_whole and are_finite(eyes, yaws, pitches)):
        return False
    for turn in range(count):
        image = item_at(Turns(order, taken), turn)
        if image == TAKEN_ALREADY:
            continue
        parts = read_workspace(workspaces[image if workspaces.shape[0] > 1 else 0])
        buffer = hit_buffer_in(width, parts.rays, parts.met, parts.strips)
        camera = camera_at(eyes[image], yaws[image], pitches[image], half_width, width, height, far)
        aim_rays(buffer, camera)
        trace_static(parts, camera, False, buffer)
        write_depths(buffer, depths[image])
    return True


@cache
def depths_tracer() -> Callable[..., bool]:
    """Return the kernel behind ``trace_static_depths``, for callers with arrays of exactly the right types.

    Tracing a small image takes hardly longer than checking three arrays in Python and passing them on. So the
    kernel itself checks its arguments. If shapes do not match, or a number is not finite, it writes nothing
    and returns False. For an argument that is not a contiguous, aligned and writable array of the right type,
    it raises TypeError, ValueError or NumbaError.

    The kernel's arguments: (N, 3) float64 m, the eyes; (N,) float64 degrees, yaws; (N,) float64 degrees,
    pitches; ``half_width`` and ``far`` of ``Cameras``; the tables of one workspace or of N; both arrays of
    ``Turns``; (N, H, W) float32, written.
    """
    numbers, depths = np.zeros(1), np.zeros((1, 1, 1), np.float32)
    tables = np.zeros((1, 1, 1), np.int64)
    return only_for(_trace_static_depths, numbers[None], numbers, numbers, 1.0, 1.0, tables, *ALONE, depths)


@inlined_kernel
def trace_static(parts: Workspace, camera: Camera, with_water: bool, buffer: HitBuffer) -> None:
    """Trace an image of a static world, whose rays have been aimed."""
    blocks = unpack_blocks(parts.numbers, parts.indices, parts.float32s)
    solids = unpack_shapes(parts.numbers, parts.indices)
    trace_world(blocks, solids, camera, with_water, _scratch_in(parts), buffer)


@inlined_kernel
def trace_moving(parts: Workspace, others: Shapes, camera: Camera, viewer: int, buffer: HitBuffer) -> None:
    """Trace moving solids in an image whose static world has been traced."""
    solids = unpack_shapes(parts.numbers, parts.indices)
    trace_moving_solids(others, solids.boxes.shape[0], camera, viewer, parts.outside, buffer)


@inlined_kernel
def _scratch_in(parts: Workspace) -> Scratch:
    """Return the scratch buffers of a workspace."""
    return Scratch(
        parts.projection,
        parts.boxes,
        parts.outside,
        parts.shown,
        parts.queue,
        parts.rings,
        parts.cells,
        parts.done,
    )


@inlined_kernel
def write_depths(buffer: HitBuffer, depths: NDArray[np.float32]) -> None:
    """Write (H, W) m, the depths of what the rays of an image hit; ``far`` without a hit."""
    for row in range(depths.shape[0]):
        line, first = depths[row], row * buffer.width
        last = first + buffer.width
        distance, met, along = buffer.distance[first:last], buffer.met[first:last], buffer.along[first:last]
        for column in range(buffer.width):
            line[column] = distance[column] * (along[column] if met[column] != NOTHING else 1.0)
