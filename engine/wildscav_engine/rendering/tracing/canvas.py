"""The rays of one image and the nearest that each has met so far."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.kernel import array_kernel, inlined_kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle

# What a ray has met is one number: a solid; NOTHING; or from there downwards, alternately
# terrain by triangle (twice the cell, and one more for the north-western) and water by cell.
NOTHING = -1


class Canvas(NamedTuple):
    """The H × W rays of one image."""

    east: NDArray[np.float64]  # (H, W) unit vectors of the rays
    up: NDArray[np.float64]
    north: NDArray[np.float64]
    distance: NDArray[np.float64]  # (H, W) m to the nearest so far, or the camera's far
    met: NDArray[np.int32]  # (H, W) what that is
    enter: NDArray[np.float64]  # (W,) m, room for a row of rays
    leave: NDArray[np.float64]  # (W,) m
    spare: NDArray[np.float64]  # (W,) m
    shortening: NDArray[np.float64]  # (H, W) cosines of the angles between the view axis and the rays
    flat: NDArray[
        np.float64
    ]  # (7, H * W) row after row: east, up, north, distance and shortening again, then
    # the tangents of each pixel, to the right and upwards


@array_kernel
def allocate_canvas(height: int, width: int, half_width: float) -> Canvas:
    """Return room for images whose half width has this tangent."""
    planes = np.empty((7, height, width))
    pixel = 2.0 * half_width / width
    for row in range(height):
        above = (height * 0.5 - row - 0.5) * pixel
        for column in range(width):
            right = (column + 0.5 - width * 0.5) * pixel
            planes[4, row, column] = 1.0 / np.sqrt(1.0 + above * above + right * right)
            planes[5, row, column] = right
            planes[6, row, column] = above
    lines = np.empty((3, width))
    met = np.empty((height, width), np.int32)
    flat = planes.reshape((7, height * width))
    east, up, north, distance, shortening = planes[0], planes[1], planes[2], planes[3], planes[4]
    return Canvas(east, up, north, distance, met, lines[0], lines[1], lines[2], shortening, flat)


@inlined_kernel
def of_triangle(triangle: int) -> int:
    """Return what stands for a triangle of the terrain."""
    return NOTHING - 1 - 2 * triangle


@inlined_kernel
def of_water(cell: int) -> int:
    """Return what stands for the water over a cell."""
    return NOTHING - 2 - 2 * cell


@inlined_kernel
def is_of_terrain(met: int) -> bool:
    """Return whether what is neither a solid nor nothing is terrain; else it is water."""
    return (NOTHING - met) % 2 == 1


@inlined_kernel
def index_of(met: int) -> int:
    """Return the triangle of the terrain or the cell of the water that is meant."""
    return (NOTHING - 1 - met) // 2


@inlined_kernel
def fill(canvas: Canvas, distance: float, met: int) -> None:
    """Let all rays meet one thing at one distance in m."""
    canvas.flat[3][:] = distance
    canvas.met[:] = met


@inlined_kernel
def start(canvas: Canvas, camera: Camera) -> None:
    """Aim all rays, which have met nothing yet."""
    fill(canvas, camera.far, NOTHING)
    east, up, north = canvas.flat[0], canvas.flat[1], canvas.flat[2]
    along, right, above = canvas.flat[4], canvas.flat[5], canvas.flat[6]
    # A pixel's direction is ahead + right · u + above · v, of which ahead + above · v rises and goes level.
    for ray in range(along.shape[0]):
        level = camera.cos_pitch + camera.sin_pitch * above[ray]
        east[ray] = (camera.sin_yaw * level + camera.cos_yaw * right[ray]) * along[ray]
    for ray in range(along.shape[0]):
        up[ray] = (camera.cos_pitch * above[ray] - camera.sin_pitch) * along[ray]
    for ray in range(along.shape[0]):
        level = camera.cos_pitch + camera.sin_pitch * above[ray]
        north[ray] = (camera.cos_yaw * level - camera.sin_yaw * right[ray]) * along[ray]


@inlined_kernel
def end_at_edges(
    canvas: Canvas, camera: Camera, west: float, south: float, width: float, height: float
) -> None:
    """Let rays meet nothing where they have left a map.

    Args:
        canvas: Written.
        camera: The image's, on the map.
        west: m, x of the map's western edge.
        south: m, z of its southern edge.
        width: m from west to east.
        height: m from south to north.
    """
    for row in range(canvas.met.shape[0]):
        for column in range(canvas.met.shape[1]):
            east, north = canvas.east[row, column], canvas.north[row, column]
            past_x = west + width - camera.x if east > 0.0 else west - camera.x
            past_z = south + height - camera.z if north > 0.0 else south - camera.z
            out_x = past_x / east if east != 0.0 else np.inf
            out_z = past_z / north if north != 0.0 else np.inf
            if canvas.distance[row, column] > min(out_x, out_z):
                canvas.distance[row, column] = camera.far
                canvas.met[row, column] = NOTHING


@inlined_kernel
def is_open(canvas: Canvas, pixels: Rectangle, distance: float) -> bool:
    """Return whether some of the rays can still meet what is at a distance in m or beyond."""
    for row in range(pixels.top, pixels.bottom):
        for column in range(pixels.left, pixels.right):
            if canvas.distance[row, column] > distance:
                return True
    return False
