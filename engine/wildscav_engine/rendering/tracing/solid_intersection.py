"""Intersecting the rays of an image with convex solids."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import (
    FEW,
    HitBuffer,
    nearer_of,
    start_in_row,
    whole_vectors,
)
from wildscav_engine.rendering.tracing.scene_arrays import Shapes


@kernel
def trace_solid(
    shapes: Shapes,
    solid: int,
    met: int,
    pixels: Rectangle,
    camera: Camera,
    planes: NDArray[np.float64],
    buffer: HitBuffer,
) -> None:
    """Intersect the rays of some pixels with a solid; ``met`` stands for it in the hit buffer.

    ``planes`` is a scratch buffer, (faces, 4).
    """
    first, last = nonnegative(shapes.face_start[solid]), nonnegative(shapes.face_start[solid + 1])
    planes = planes[: last - first]
    fronts = _sort_faces(shapes.faces[first:last], camera, planes)
    rays, beyond = buffer.met.shape[0], 2.0 * camera.far
    if rays <= FEW:
        # All rays from the first to the last: the few extra rays cost less than many short loops.
        start, end = (
            pixels.top * buffer.width + pixels.left,
            (pixels.bottom - 1) * buffer.width + pixels.right,
        )
        count = whole_vectors(buffer, end - start)
        _intersect_together(planes, fronts, met, nonnegative(min(start, rays - count)), count, beyond, buffer)
        return
    count = whole_vectors(buffer, pixels.right - pixels.left)
    for row in range(pixels.top, pixels.bottom):
        start = start_in_row(buffer, pixels, row, count)
        _intersect_together(planes, fronts, met, start, count, beyond, buffer)


@inlined_kernel
def _sort_faces(faces: NDArray[np.float64], camera: Camera, planes: NDArray[np.float64]) -> int:
    """Copy (F, 4) the faces of a solid, first those that the eye is outside of; return how many these are.

    In place of its offset, each has the distance of the eye from its plane, m outside.
    """
    front, back = 0, faces.shape[0]
    for face in range(faces.shape[0]):
        x, y, z = faces[face, 0], faces[face, 1], faces[face, 2]
        outside = x * camera.x + y * camera.y + z * camera.z - faces[face, 3]
        is_front = outside > 0.0
        back -= not is_front
        plane = planes[nonnegative(front if is_front else back)]
        plane[0], plane[1], plane[2], plane[3] = x, y, z, outside
        front += is_front
    return front


@disjoint_kernel
def _intersect_together(
    planes: NDArray[np.float64],
    fronts: int,
    met: int,
    first: int,
    count: int,
    beyond: float,
    buffer: HitBuffer,
) -> None:
    """Do for many rays what ``rays.intersect_solid`` does for one, in loops that vectorize."""
    # Slices that start at 0 make indices provably non-negative; a check for negative ones would prevent
    # vectorization. No loop over faces writes an array that it reads, which would also prevent it.
    last = first + count
    enter, leave, spare = buffer.enter[:count], buffer.leave[:count], buffer.spare[:count]
    east, up, north = buffer.east[first:last], buffer.up[first:last], buffer.north[first:last]
    distance, mets = buffer.distance[first:last], buffer.met[first:last]
    for ray in range(count):
        enter[ray] = 0.0
    for face in range(fronts):
        nx, ny, nz, out = planes[face, 0], planes[face, 1], planes[face, 2], planes[face, 3]
        for ray in range(count):
            speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
            crossing = -out / speed
            spare[ray] = max(enter[ray], crossing if speed < 0.0 else beyond)
        enter, spare = spare, enter
    nearer = 0
    for ray in range(count):
        nearer += enter[ray] < distance[ray]
    if nearer == 0:
        return
    for ray in range(count):
        leave[ray] = beyond
    for face in range(fronts, planes.shape[0]):
        nx, ny, nz, out = planes[face, 0], planes[face, 1], planes[face, 2], planes[face, 3]
        for ray in range(count):
            speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
            crossing = -out / speed
            spare[ray] = min(leave[ray], crossing if speed > 0.0 else beyond)
        leave, spare = spare, leave
    for ray in range(count):
        hit = enter[ray] if enter[ray] <= leave[ray] else beyond
        distance[ray], mets[ray] = nearer_of(hit, met, distance[ray], mets[ray])


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
