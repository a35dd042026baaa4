"""Intersecting the rays of an image with convex solids."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import FEW, HitBuffer, even_count, start_in_row
from wildscav_engine.rendering.tracing.packing import Shapes


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
    """Intersect the rays of some pixels with a solid.

    Args:
        shapes: The world's solids or the moving ones.
        solid: Index of the solid in them.
        met: The number that stands for it in the hit buffer.
        pixels: The pixels that it may cover.
        camera: The camera of the image.
        outside: Scratch buffer with a number for each face of the solid.
        buffer: The hit buffer of the image, written.
    """
    first, last = nonnegative(shapes.face_start[solid]), nonnegative(shapes.face_start[solid + 1])
    faces = shapes.faces[first:last]
    for face in range(last - first):
        plane = faces[face]
        outside[face] = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
    beyond = 2.0 * camera.far
    if buffer.met.shape[0] <= FEW:
        # All rays from the first to the last: the few extra rays cost less than many short loops.
        top, bottom = pixels.top * buffer.width, (pixels.bottom - 1) * buffer.width
        _meet_together(faces, outside, met, top + pixels.left, bottom + pixels.right, beyond, buffer)
        return
    count = even_count(buffer, pixels)
    for row in range(pixels.top, pixels.bottom):
        start = start_in_row(buffer, pixels, row, count)
        _meet_together(faces, outside, met, start, start + count, beyond, buffer)


@disjoint_kernel
def _meet_together(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    first: int,
    last: int,
    beyond: float,
    buffer: HitBuffer,
) -> None:
    """Do for many rays what ``rays.meet_solid`` does for one, in loops that vectorize."""
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
def entered_face(shapes: Shapes, solid: int, camera: Camera, ray: tuple[float, float, float]) -> int:
    """Return the face through which a ray enters a solid that it hits: the last one it crosses from outside.

    The index counts among the solid's faces; it is 0 if the eye is inside.
    """
    first, enter, entered = shapes.face_start[solid], 0.0, 0
    for face in range(first, shapes.face_start[solid + 1]):
        plane = shapes.faces[face]
        outside = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
        speed = plane[0] * ray[0] + plane[1] * ray[1] + plane[2] * ray[2]
        if outside > 0.0 and -outside / speed > enter:
            enter, entered = -outside / speed, face - first
    return entered
