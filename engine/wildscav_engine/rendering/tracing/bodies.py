"""Convex solids on an image."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.tracing.canvas import FEW, Canvas
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, natural
from wildscav_engine.rendering.tracing.packing import Shapes

NARROW = 4  # columns; up to so many, ray after ray is faster than face after face


@kernel
def paint_solid(
    shapes: Shapes,
    solid: int,
    met: int,
    pixels: Rectangle,
    camera: Camera,
    outside: NDArray[np.float64],
    canvas: Canvas,
) -> None:
    """Let the rays of some pixels meet a solid.

    Args:
        shapes: All of its sort.
        solid: Which.
        met: What stands for it on the canvas.
        pixels: All that it can lie on.
        camera: The image's.
        outside: Room for as many numbers as it has faces.
        canvas: The image, written.
    """
    first, last = natural(shapes.face_start[solid]), natural(shapes.face_start[solid + 1])
    faces = shapes.faces[first:last]
    for face in range(last - first):
        plane = faces[face]
        outside[face] = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
    top, bottom, width = pixels.top * canvas.width, pixels.bottom * canvas.width, canvas.width
    if pixels.right - pixels.left <= NARROW:
        for row in range(top, bottom, width):
            _meet_one_by_one(faces, outside, met, row + pixels.left, row + pixels.right, canvas)
    elif canvas.met.shape[0] <= FEW:
        # All rays from the first to the last: so few more are met faster than many short rows.
        first, last = top + pixels.left, bottom - width + pixels.right
        _meet_together(faces, outside, met, first, last, 2.0 * camera.far, canvas)
    else:
        for row in range(top, bottom, width):
            first, last = row + pixels.left, row + pixels.right
            _meet_together(faces, outside, met, first, last, 2.0 * camera.far, canvas)


@inlined_kernel
def _meet_one_by_one(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    first: int,
    last: int,
    canvas: Canvas,
) -> None:
    for place in range(first, last):
        ray = natural(place)
        nearest = canvas.distance[ray]
        way = (canvas.east[ray], canvas.up[ray], canvas.north[ray])
        distance = _meet(faces, outside, way, nearest)
        if distance < nearest:
            canvas.distance[ray] = distance
            canvas.met[ray] = met


@inlined_kernel
def _meet(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    ray: tuple[float, float, float],
    nearest: float,
) -> float:
    """Return where a ray enters a solid, m; inf if not before ``nearest``. See ``rays.meet_solid``."""
    enter, leave = 0.0, nearest
    for face in range(faces.shape[0]):
        speed = faces[face, 0] * ray[0] + faces[face, 1] * ray[1] + faces[face, 2] * ray[2]
        crossing = -outside[face] / speed
        is_front = outside[face] > 0.0
        enter = max(enter, (crossing if speed < 0.0 else np.inf) if is_front else 0.0)
        leave = min(leave, crossing if (speed > 0.0) & (not is_front) else np.inf)
    return enter if enter <= leave else np.inf


@kernel
def _meet_together(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    first: int,
    last: int,
    beyond: float,
    canvas: Canvas,
) -> None:
    """Do for many rays what ``_meet`` does for one: loops without branches, several rays at once."""
    # Indices that count from 0 need no check for negative ones, which would keep the loops from being fast.
    # And what is read is never what is written: else only what changes would be written, one by one.
    count = last - first
    enter, leave, spare = canvas.enter[:count], canvas.leave[:count], canvas.spare[:count]
    east, up, north = canvas.east[first:last], canvas.up[first:last], canvas.north[first:last]
    distance, mets = canvas.distance[first:last], canvas.met[first:last]
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
    """Return the face by which a ray enters a solid that it meets: the last that it passes from outside.

    Counted among the solid's faces; 0 if the eye is inside.
    """
    first, enter, entered = shapes.face_start[solid], 0.0, 0
    for face in range(first, shapes.face_start[solid + 1]):
        plane = shapes.faces[face]
        outside = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
        speed = plane[0] * ray[0] + plane[1] * ray[1] + plane[2] * ray[2]
        if outside > 0.0 and -outside / speed > enter:
            enter, entered = -outside / speed, face - first
    return entered
