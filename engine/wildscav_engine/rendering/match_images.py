"""Tracing the images of cameras in different matches, each on its map and with what moves in it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectArrays, shapes_between
from wildscav_engine.rendering.trace import trace_moving, trace_static
from wildscav_engine.rendering.tracing.frustum import Camera, camera_at
from wildscav_engine.rendering.tracing.hit_buffer import HitBuffer, aim_rays, hit_buffer_in
from wildscav_engine.rendering.tracing.packing import Shapes, unpack_shapes
from wildscav_engine.rendering.tracing.workspace import Workspace, read_workspace


class Matches(NamedTuple):
    """Matches that are seen, as kernels read them."""

    workspaces: NDArray[np.int64]  # (N, F, 6) the tables of the workspaces for N cameras, or of one for all
    objects: ObjectArrays  # the moving objects of all matches
    start: NDArray[np.int64]  # (M + 1,) where those of each match start
    seen: NDArray[np.int64]  # (N,) the match that each camera is in


class TracedImage(NamedTuple):
    """An image, and what its rays hit."""

    workspace: Workspace
    camera: Camera
    solids: Shapes  # of the world
    moving: Shapes
    buffer: HitBuffer


@inlined_kernel
def trace_in_match(
    matches: Matches, cameras: Cameras, image: int, height: int, width: int, with_water: bool
) -> TracedImage:
    """Trace the image of one of some cameras, and return it; it is valid until the next one is traced."""
    workspace, moving = workspace_of(matches, image), shapes_of_match(matches, image)
    buffer = hit_buffer_in(width, workspace.rays, workspace.met, workspace.strips)
    eye, yaw, pitch = cameras.eyes[image], cameras.yaws[image], cameras.pitches[image]
    camera = camera_at(eye, yaw, pitch, cameras.half_width, width, height, cameras.far)
    aim_rays(buffer, camera)
    trace_static(workspace, camera, with_water, buffer)
    trace_moving(workspace, moving, camera, cameras.viewers[image], buffer)
    solids = unpack_shapes(workspace.numbers, workspace.indices)
    return TracedImage(workspace, camera, solids, moving, buffer)


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
