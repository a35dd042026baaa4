"""Convex solids on an image."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.tracing.canvas import Canvas, is_open
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, outline_of_box, pixels_of
from wildscav_engine.rendering.tracing.packing import Shapes

NARROW = 4  # columns; up to so many, ray after ray is faster than face after face


@inlined_kernel
def paint_solid(
    shapes: Shapes, solid: int, met: int, camera: Camera, outside: NDArray[np.float64], canvas: Canvas
) -> None:
    """Let the rays of an image meet a solid.

    Args:
        shapes: All of its sort.
        solid: Which.
        met: What stands for it on the canvas.
        camera: The image's.
        outside: Room for as many numbers as it has faces.
        canvas: The image, written.
    """
    outline = outline_of_box(camera, shapes.boxes[solid])
    pixels = pixels_of(camera, outline)
    # No ray is shorter than the way ahead of what it meets.
    if pixels.left >= pixels.right or not is_open(canvas, pixels, outline.nearest):
        return
    first, last = shapes.face_start[solid], shapes.face_start[solid + 1]
    faces = shapes.faces[first:last]
    for face in range(last - first):
        plane = faces[face]
        outside[face] = plane[0] * camera.x + plane[1] * camera.y + plane[2] * camera.z - plane[3]
    if pixels.right - pixels.left <= NARROW:
        _meet_one_by_one(faces, outside, met, pixels, canvas)
    else:
        _meet_by_rows(faces, outside, met, pixels, 2.0 * camera.far, canvas)


@inlined_kernel
def _meet_one_by_one(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    pixels: Rectangle,
    canvas: Canvas,
) -> None:
    for row in range(pixels.top, pixels.bottom):
        for column in range(pixels.left, pixels.right):
            nearest = canvas.distance[row, column]
            ray = (canvas.east[row, column], canvas.up[row, column], canvas.north[row, column])
            distance = _meet(faces, outside, ray, nearest)
            if distance < nearest:
                canvas.distance[row, column] = distance
                canvas.met[row, column] = met


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
def _meet_by_rows(
    faces: NDArray[np.float64],
    outside: NDArray[np.float64],
    met: int,
    pixels: Rectangle,
    beyond: float,
    canvas: Canvas,
) -> None:
    """Do for whole rows what ``_meet`` does for a ray: loops without branches, several rays at once."""
    left, right = pixels.left, pixels.right
    # Indices that count from 0 need no check for negative ones, which would keep the loops from being fast.
    # And what is read is never what is written: else only what changes would be written, one by one.
    enter, leave, spare = (
        canvas.enter[: right - left],
        canvas.leave[: right - left],
        canvas.spare[: right - left],
    )
    for row in range(pixels.top, pixels.bottom):
        east, up, north = (
            canvas.east[row, left:right],
            canvas.up[row, left:right],
            canvas.north[row, left:right],
        )
        distance, mets = canvas.distance[row, left:right], canvas.met[row, left:right]
        for ray in range(right - left):
            enter[ray] = 0.0
        for ray in range(right - left):
            leave[ray] = distance[ray]
        for face in range(faces.shape[0]):
            nx, ny, nz, out = faces[face, 0], faces[face, 1], faces[face, 2], outside[face]
            if out > 0.0:
                for ray in range(right - left):
                    speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
                    crossing = -out / speed
                    spare[ray] = max(enter[ray], crossing if speed < 0.0 else beyond)
                enter, spare = spare, enter
            else:
                for ray in range(right - left):
                    speed = nx * east[ray] + ny * up[ray] + nz * north[ray]
                    crossing = -out / speed
                    spare[ray] = min(leave[ray], crossing if speed > 0.0 else beyond)
                leave, spare = spare, leave
        for ray in range(right - left):
            nearer = (enter[ray] <= leave[ray]) & (enter[ray] < distance[ray])
            mets[ray] += nearer * (met - mets[ray])
        for ray in range(right - left):
            spare[ray] = min(distance[ray], enter[ray] if enter[ray] <= leave[ray] else beyond)
        for ray in range(right - left):
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
