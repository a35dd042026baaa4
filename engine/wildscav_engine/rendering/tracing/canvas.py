"""The rays of one image and the nearest that each has met so far."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, natural

# What a ray has met is one number: a solid; NOTHING; or from there downwards, alternately
# terrain by triangle (twice the cell, and one more for the north-western) and water by cell.
NOTHING = -1
FEW = 256  # rays; so small an image is one strip


class Canvas(NamedTuple):
    """The N rays of one image, row after row."""

    width: int  # of a row
    east: NDArray[np.float64]  # (N,) unit vectors of the rays
    up: NDArray[np.float64]
    north: NDArray[np.float64]
    distance: NDArray[np.float64]  # (N,) m to the nearest so far, or the camera's far
    met: NDArray[np.int32]  # (N,) what that is
    along: NDArray[np.float64]  # (N,) cosines of the angles between the view axis and the rays
    right: NDArray[np.float64]  # (N,) tangents of the pixels' middles
    above: NDArray[np.float64]  # (N,)
    enter: NDArray[np.float64]  # (strip,) m, room for some rays
    leave: NDArray[np.float64]  # (strip,) m
    spare: NDArray[np.float64]  # (strip,) m


def allocate_rays(height: int, width: int, half_width: float) -> NDArray[np.float64]:
    """Return (7, height * width): room for rays, and what does not depend on where a camera looks.

    Args:
        height: Of the image, pixels.
        width: Likewise.
        half_width: The tangent of half the angle that is seen.
    """
    rays = np.empty((7, height, width))
    pixel = 2.0 * half_width / width
    right = ((np.arange(width) + 0.5 - width * 0.5) * pixel)[None, :]
    above = ((height * 0.5 - np.arange(height) - 0.5) * pixel)[:, None]
    rays[4] = 1.0 / np.sqrt(1.0 + above * above + right * right)
    rays[5], rays[6] = right, above
    return rays.reshape(7, height * width)


def allocate_strips(height: int, width: int) -> NDArray[np.float64]:
    """Return (3, strip): room for the rays that are looked at together, a row or a small image."""
    return np.empty((3, max(width, min(height * width, FEW))))


@inlined_kernel
def canvas_on(
    width: int, rays: NDArray[np.float64], met: NDArray[np.int32], strips: NDArray[np.float64]
) -> Canvas:
    """Return a canvas in the room that was made for it."""
    return Canvas(
        width,
        rays[0],
        rays[1],
        rays[2],
        rays[3],
        met,
        rays[4],
        rays[5],
        rays[6],
        strips[0],
        strips[1],
        strips[2],
    )


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
    canvas.distance[:] = distance
    canvas.met[:] = met


@inlined_kernel
def start(canvas: Canvas, camera: Camera) -> None:
    """Aim all rays, which have met nothing yet."""
    fill(canvas, camera.far, NOTHING)
    east, up, north = canvas.east, canvas.up, canvas.north
    along, right, above = canvas.along, canvas.right, canvas.above
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
    for ray in range(canvas.met.shape[0]):
        east, north = canvas.east[ray], canvas.north[ray]
        past_x = west + width - camera.x if east > 0.0 else west - camera.x
        past_z = south + height - camera.z if north > 0.0 else south - camera.z
        out_x = past_x / east if east != 0.0 else np.inf
        out_z = past_z / north if north != 0.0 else np.inf
        if canvas.distance[ray] > min(out_x, out_z):
            canvas.distance[ray] = camera.far
            canvas.met[ray] = NOTHING


@inlined_kernel
def is_open(canvas: Canvas, pixels: Rectangle, distance: float) -> bool:
    """Return whether some of the rays can still meet what is at a distance in m or beyond."""
    for row in range(pixels.top, pixels.bottom):
        for column in range(pixels.left, pixels.right):
            if canvas.distance[natural(row * canvas.width + column)] > distance:
                return True
    return False
