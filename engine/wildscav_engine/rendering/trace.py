"""Ray tracing for cameras: what the ray of each pixel hits first.

All rays of an image start at one eye, so an image is traced object by object instead of ray by ray. Blocks of
cells are visited from near to far. In each block, the cells and solids that may be visible are projected onto
the image, and only the rays of the pixels they cover are intersected with them. Objects that cannot be nearer
than the hits found so far are skipped. The result of a ray is the nearest of the same intersections, computed
in the same way, whichever image the ray belongs to.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel, specialize
from wildscav_engine.parallel.turns import ALONE, Turns
from wildscav_engine.rendering.cameras import TAKEN_ALREADY, Cameras, are_finite, item_at
from wildscav_engine.rendering.dynamic_objects import ObjectArrays, ObjectSets, read_objects, shapes_between
from wildscav_engine.rendering.tracing.front_to_back import trace_moving_solids, trace_world
from wildscav_engine.rendering.tracing.frustum import Camera, camera_at, pinhole
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, aim_rays, hit_buffer_in
from wildscav_engine.rendering.tracing.scene import Scene, Scenes, scene_of
from wildscav_engine.rendering.tracing.scene_arrays import Shapes
from wildscav_engine.rendering.tracing.workspace import Size, Workspace, read_workspace

__all__ = [
    "Scene",
    "Scenes",
    "depths_tracer",
    "scene_of",
    "trace_static_depths",
]

CAMERAS = len(Cameras._fields)  # the arguments of ``*views`` that are of cameras
TURNS = CAMERAS + 4  # where those of turns start


def trace_static_depths(
    scenes: Scene | Scenes, size: Size, cameras: Cameras, depths: NDArray[np.float32], turns: Turns = ALONE
) -> bool:
    """Write depths as ``images.trace_images`` does, faster, where nothing moves."""
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
        buffer = hit_buffer_in(width, parts.image)
        optics = pinhole(half_width, width, height)
        camera = camera_at(eyes[image], yaws[image], pitches[image], optics, width, height, far)
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
    return specialize(_trace_static_depths, numbers[None], numbers, numbers, 1.0, 1.0, tables, *ALONE, depths)


@inlined_kernel
def trace_static(parts: Workspace, camera: Camera, with_water: bool, buffer: HitBuffer) -> None:
    """Trace an image of a static world, whose rays have been aimed."""
    trace_world(parts.blocks, parts.solids, camera, with_water, parts.scratch, buffer)


@inlined_kernel
def trace_moving(parts: Workspace, others: Shapes, camera: Camera, viewer: int, buffer: HitBuffer) -> None:
    """Trace moving solids in an image whose static world has been traced."""
    statics = parts.solids.obbs.shape[0]
    trace_moving_solids(others, statics, camera, viewer, parts.scratch.planes, buffer)


@inlined_kernel
def write_depths(buffer: HitBuffer, depths: NDArray[np.float32]) -> None:
    """Write (H, W) m, the depths of what the rays of an image hit; ``far`` without a hit."""
    for row in range(depths.shape[0]):
        line, first = depths[row], row * buffer.width
        last = first + buffer.width
        distance, met, along = buffer.distance[first:last], buffer.met[first:last], buffer.along[first:last]
        for column in range(buffer.width):
            line[column] = distance[column] * (along[column] if met[column] != NOTHING else 1.0)


class Matches(NamedTuple):
    """Matches that are seen, as kernels read them."""

    workspaces: NDArray[np.int64]  # (N, F, 6) the tables of the workspaces for N cameras, or of one for all
    objects: ObjectArrays  # the moving objects of all matches
    start: NDArray[np.int64]  # (M + 1,) where those of each match start
    seen: NDArray[np.int64]  # (N,) the match that each camera is in


class Views(NamedTuple):
    """The views of N cameras, and in which order a thread comes to them."""

    cameras: Cameras
    matches: Matches
    turns: Turns


def flatten_views(
    scenes: Scene | Scenes,
    objects: ObjectSets,
    matches: NDArray[np.int64],
    cameras: Cameras,
    turns: Turns,
    size: Size,
) -> tuple[Any, ...]:
    """Return the views of some cameras as the last arguments of a kernel, which takes them as ``*views``.

    For the arguments, see ``images.trace_images``; ``size`` is that of the images, and of the largest of the
    moving objects. The views include addresses: the caller must keep the scenes and objects alive during the
    call.
    """
    return *cameras, scenes.tables(size), objects.addresses, objects.start, matches, *turns


@inlined_kernel
def read_views(flat: tuple[Any, ...]) -> Views:
    """Return the views that ``flatten_views`` flattened."""
    workspaces, objects, start, seen = flat[CAMERAS:TURNS]
    matches = Matches(workspaces, read_objects(objects), start, seen)
    return Views(Cameras(*flat[:CAMERAS]), matches, Turns(*flat[TURNS:]))


class TracedImage(NamedTuple):
    """An image, and what its rays hit."""

    workspace: Workspace
    camera: Camera
    solids: Shapes  # of the world
    moving: Shapes
    buffer: HitBuffer


@inlined_kernel
def trace_view(views: Views, image: int, height: int, width: int, with_water: bool) -> TracedImage:
    """Trace the image of one of some cameras, and return it; it is valid until the next one is traced."""
    matches, cameras = views.matches, views.cameras
    workspace, moving = workspace_of(matches, image), shapes_of_match(matches, image)
    buffer = hit_buffer_in(width, workspace.image)
    eye, yaw, pitch = cameras.eyes[image], cameras.yaws[image], cameras.pitches[image]
    optics = pinhole(cameras.half_width, width, height)
    camera = camera_at(eye, yaw, pitch, optics, width, height, cameras.far)
    aim_rays(buffer, camera)
    trace_static(workspace, camera, with_water, buffer)
    trace_moving(workspace, moving, camera, cameras.viewers[image], buffer)
    return TracedImage(workspace, camera, workspace.solids, moving, buffer)


@inlined_kernel
def workspace_of(matches: Matches, image: int) -> Workspace:
    """Return what an image is traced in."""
    place = image if matches.workspaces.shape[0] > 1 else 0
    workspace: Workspace = read_workspace(matches.workspaces[place])
    return workspace


@inlined_kernel
def shapes_of_match(matches: Matches, image: int) -> Shapes:
    """Return the moving objects that an image may show."""
    first, last = objects_in(matches, image)
    return shapes_between(matches.objects, first, last)


@inlined_kernel
def objects_in(matches: Matches, image: int) -> tuple[int, int]:
    """Return where the objects of the match of a camera start, and where those of the next match do."""
    match = matches.seen[image]
    return matches.start[match], matches.start[match + 1]
