"""The hit buffer of one image: its rays, and the nearest hit of each so far."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle, nonnegative

# What a ray hit is encoded as one number: the index of a solid; NOTHING; or below that, alternately the
# triangles of the terrain (numbered twice the cell, plus one for the north-western) and the cells of water.
NOTHING = -1
GREATEST: Any = np.int32(2**31 - 2)  # number of a code
FEW = 256  # rays; an image with at most this many is processed as one strip
MOST_AT_ONCE = 8  # rays that a processor intersects


class HitBuffer(NamedTuple):
    """The N rays of one image, row after row, and their nearest hits so far."""

    width: int  # of a row
    at_once: int  # see ``ImageArrays``
    east: NDArray[np.float64]  # (N,) unit vectors of the rays
    up: NDArray[np.float64]
    north: NDArray[np.float64]
    distance: NDArray[np.float64]  # (N,) m to the nearest hit so far, or the camera's ``far``
    met: NDArray[np.int32]  # (N,) the code of what was hit
    along: NDArray[np.float64]  # (N,) cosines of the angles between the view axis and the rays
    right: NDArray[np.float64]  # (N,) tangents of the pixel centres
    above: NDArray[np.float64]  # (N,)
    enter: NDArray[np.float64]  # (strip,) m, scratch buffer
    leave: NDArray[np.float64]  # (strip,) m
    spare: NDArray[np.float64]  # (strip,) m


class ImageArrays(NamedTuple):
    """The arrays that hold an image of N pixels while it is traced."""

    rays: NDArray[np.float64]  # (7, N) all of a ``HitBuffer`` that there is for each of them but its codes
    met: NDArray[np.int32]  # (N,)
    at_once: NDArray[np.int64]  # (1,) the rays that the processor intersects at once, a power of two
    strips: NDArray[np.float64]  # (3, strip) for the rays processed together: of a row, or of a small image


def allocate_image(height: int, width: int, half_width: float, at_once: int = MOST_AT_ONCE) -> ImageArrays:
    """Return the arrays for an image, with what does not depend on the pose of the camera."""
    rays = np.empty((7, height, width))
    pixel = 2.0 * half_width / width
    right = ((np.arange(width) + 0.5 - width * 0.5) * pixel)[None, :]
    above = ((height * 0.5 - np.arange(height) - 0.5) * pixel)[:, None]
    rays[4] = 1.0 / np.sqrt(1.0 + above * above + right * right)
    rays[5], rays[6] = right, above
    strips = np.empty((3, max(width + MOST_AT_ONCE, min(height * width, FEW))))
    met = np.empty(height * width, np.int32)
    return ImageArrays(rays.reshape(7, height * width), met, np.array([at_once]), strips)


@inlined_kernel
def hit_buffer_in(width: int, image: ImageArrays) -> HitBuffer:
    """Return a hit buffer as views of the arrays allocated for it."""
    rays, strips = image.rays, image.strips
    return HitBuffer(
        width,
        image.at_once[0],
        rays[0],
        rays[1],
        rays[2],
        rays[3],
        image.met,
        rays[4],
        rays[5],
        rays[6],
        strips[0],
        strips[1],
        strips[2],
    )


@inlined_kernel
def code_of_triangle(triangle: int) -> int:
    """Return the code of a triangle of the terrain."""
    return NOTHING - 1 - 2 * triangle


@inlined_kernel
def code_of_water(cell: int) -> int:
    """Return the code of the water over a cell."""
    return NOTHING - 2 - 2 * cell


@inlined_kernel
def is_terrain_code(met: int) -> bool:
    """Return whether a code below NOTHING stands for terrain; else it stands for water."""
    return (NOTHING - met) & 1 == 1


@inlined_kernel
def index_in_code(met: int) -> int:
    """Return the triangle of the terrain or the cell of water that a code below NOTHING stands for."""
    return (NOTHING - 1 - met) >> 1


@inlined_kernel
def fill(buffer: HitBuffer, distance: float, met: int) -> None:
    """Set the hits of all rays to one distance in m and one code."""
    buffer.distance[:] = distance
    buffer.met[:] = met


@inlined_kernel
def aim_rays(buffer: HitBuffer, camera: Camera) -> None:
    """Set the directions of all rays and clear their hits."""
    fill(buffer, camera.far, NOTHING)
    east, up, north = buffer.east, buffer.up, buffer.north
    along, right, above = buffer.along, buffer.right, buffer.above
    # A pixel's direction is ahead + right · u + above · v; ``level`` is the horizontal part of ahead + above
    # · v.
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
    buffer: HitBuffer, camera: Camera, west: float, south: float, width: float, height: float
) -> None:
    """Clear hits beyond the edges of the map; the camera is on it.

    ``west`` is the x of the western edge and ``south`` the z of the southern one; all numbers are in m.
    """
    for ray in range(buffer.met.shape[0]):
        east, north = buffer.east[ray], buffer.north[ray]
        past_x = west + width - camera.x if east > 0.0 else west - camera.x
        past_z = south + height - camera.z if north > 0.0 else south - camera.z
        out_x = past_x / east if east != 0.0 else np.inf
        out_z = past_z / north if north != 0.0 else np.inf
        if buffer.distance[ray] > min(out_x, out_z):
            buffer.distance[ray] = camera.far
            buffer.met[ray] = NOTHING


@inlined_kernel
def nearer_of(distance: float, met: int, distance_before: float, met_before: int) -> tuple[float, int]:
    """Return the nearer of two hits, in m and as codes.

    Store the result whether it has changed or not. To store the numbers of only some rays of a vector takes
    several times as long on many processors, and the compiler does so if it sees that the others are
    written back as they were read. So these pass through functions that change no distance and no code.
    """
    kept, met_kept = abs(distance_before), min(met_before, GREATEST)
    return min(distance, kept), met if distance < kept else met_kept


@inlined_kernel
def whole_vectors(buffer: HitBuffer, count: int) -> int:
    """Return how many successive rays to process for some of them: whole vectors.

    The processor computes a group as fast as one ray. Any rays left over would be computed one by one, which
    takes longer than the few further rays of the image that the last group contains.
    """
    return int(min(buffer.met.shape[0], (count + buffer.at_once - 1) & -buffer.at_once))


@inlined_kernel
def start_in_row(buffer: HitBuffer, pixels: Rectangle, row: int, count: int) -> int:
    """Return the first of ``whole_vectors`` of rays that contain those of some pixels in a row."""
    return nonnegative(min(row * buffer.width + pixels.left, buffer.met.shape[0] - count))


@inlined_kernel
def reaches_beyond(buffer: HitBuffer, pixels: Rectangle, distance: float) -> bool:
    """Return whether some of the rays can still hit something at a distance in m or beyond."""
    for row in range(pixels.top, pixels.bottom):
        for column in range(pixels.left, pixels.right):
            if buffer.distance[nonnegative(row * buffer.width + column)] > distance:
                return True
    return False
