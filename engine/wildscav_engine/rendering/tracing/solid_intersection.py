"""Intersecting the rays of an image with convex solids."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import FEW, HitBuffer, even_count, start_in_row
from wildscav_engine.rendering.tracing.scene_arrays import Shapes


@kernel
def trace_solid(
    shapes: Shapes,
    solid: int,
    met: int,
    pixels: Rectangle,
    camera: Camera,
    outside: NDArray[np.float64],
    buffer: HitBuffer,
) -> None:
    """Intersect the rays of some pixels with a solid; ``met`` stands for it in the hit buffer."""
    first, last = nonnegative(shapes.face_start[solid]), nonnegative(shapes.face_start[solid + 1])
    faces = shapes.faces[first:last]
    for face in range(last - first):
        plane = faces[face]
        outside[face] = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
    beyond = 2.0 * camera.far
    if buffer.met.shape[0] <= FEW:
        # All rays from the first to the last: the few extra rays cost less than many short loops.
        top, bottom = pixels.top * buffer.width, (pixels.bottom - 1) * buffer.width
        _intersect_together(faces, outside, met, top + pixels.left, bottom + pixels.right, beyond, buffer)
        return
    count = even_count(buffer, pixels)
    for row in range(pixels.top, pixels.bottom):
        start = start_in_row(buffer, pixels, row, count)
        _intersect_together(faces, outside, met, start, start + count, beyond, buffer)


@disjoint_kernel
def _intersect_together(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    first: int,
    last: int,
    beyond: float,
    buffer: HitBuffer,
) -> None:
    """Do for many rays what ``rays.intersect_solid`` does for one, in loops that vectorize."""
    # Slices that start at 0 make indices provably non-negative; a check for negative ones would prevent
    # vectorization. No loop writes an array that it reads, which would also prevent it.
    count = last - first
    enter, leave, spare = buffer.enter[:count], buffer.leave[:count], buffer.spare[:count]
    east, up, north = buffer.east[first:last], buffer.up[first:last], buffer.north[first:last]
    distance, mets = buffer.distance[first:last], buffer.met[first:last]
    for ray in range(count):
        enter[ray] = 0.0
    for ray in range(count):
        leave[ray] = distance[ray]
    for face in range(faces.shape[0]):
        nx, ny, nz, out = faces[face, 0], faces[face, 1], faces[face, 2], outside[face]
        if out > 0.0:
            for ray in range(count):
                speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
                crossing = -out / speed
                spare[ray] = max(enter[ray], crossing if speed < 0.0 else beyond)
            enter, spare = spare, enter
        else:
            for ray in range(count):
                speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
                crossing = -out / speed
                spare[ray] = min(leave[ray], crossing if speed > 0.0 else beyond)
            leave, spare = spare, leave
    for ray in range(count):
        nearer = (enter[ray] <= leave[ray]) & (enter[ray] < distance[ray])
        mets[ray] += nearer * (met - mets[ray])
    for ray in range(count):
        spare[ray] = min(distance[ray], enter[ray] if enter[ray] <= leave[ray] else beyond)
    for ray in range(count):
        distance[ray] = spare[ray]


@inlined_kernel
def write_entered_faces(
    shapes: Shapes,
    solid: int,
    camera: Camera,
    start: int,
    first_name: int,
    buffer: HitBuffer,
    entered: NDArray[np.int32],
) -> None:
    """Write the faces through which successive rays enter a solid that all of them hit.

    It is the last face that a ray crosses from outside; the first face if the eye is inside.

    Args:
        start: The first ray.
        first_name: What the first face of the solid is called; the others are numbered consecutively.
        entered: (C,) the face of each ray, written.
    """
    entered[:] = first_name
    enter = buffer.enter[: entered.shape[0]]
    enter[:] = 0.0
    start = nonnegative(start)
    last = start + entered.shape[0]
    first = nonnegative(shapes.face_start[solid])
    for face in range(first, shapes.face_start[solid + 1]):
        plane = shapes.faces[face]
        outside = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
        if outside > 0.0:
            rays = buffer.east[start:last], buffer.up[start:last], buffer.north[start:last]
            _enter_face(plane, outside, rays, first_name + face - first, enter, entered)


@disjoint_kernel
def _enter_face(
    plane: NDArray[np.float64],
    outside: float,
    rays: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    name: int,
    enter: NDArray[np.float64],
    entered: NDArray[np.int32],
) -> None:
    """Set the face that rays cross last so far, and how far away."""
    east, up, north = rays
    n_x, n_y, n_z = plane[0], plane[1], plane[2]
    for ray in range(entered.shape[0]):
        crossing = -outside / (n_x * east[ray] + n_y * up[ray] + n_z * north[ray])
        is_later = crossing > enter[ray]
        enter[ray] = crossing if is_later else enter[ray]
        entered[ray] = name if is_later else entered[ray]
