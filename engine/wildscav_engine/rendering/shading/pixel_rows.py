"""A row of pixels: its rays, the same as those of ``trace``, what is computed for them, and space for it."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import Hits
from wildscav_engine.rendering.shading.color_arithmetic import Vector, dot

LEAST_FACING = 0.2  # cosine between a normal and the way to the eye; pixels are no longer at flatter angles
LEAST_FACING_32 = np.float32(LEAST_FACING)
ROWS = 21  # of numbers that a row of pixels needs
COLOR, UNOCCLUDED, NORMAL, TILT, PLACE, OTHERS = 3, 6, 8, 11, 14, 17  # the first row of each
AT_ONCE = 128  # pixels, whose numbers stay in the fastest cache
FLOATS = 9  # buffers of float32; the other ones are int32


class View(NamedTuple):
    """One camera and its image size."""

    eye: Vector  # m
    sin_yaw: float
    cos_yaw: float
    sin_pitch: float
    cos_pitch: float
    pixel: float  # side of a pixel at distance 1 m along the axis, m
    detail: float  # the same of the pixels that share one colour
    left: float  # tangent of the angle to the right of the view axis of the first column's pixels
    top: float  # the same upwards of the first row
    height: int  # pixels
    width: int
    least_cosine: float  # of the angle between a ray and the view axis: of one at a corner of the image


@kernel
def view_of(cameras: Cameras, image: int, height: int, width: int, shared: int) -> View:
    """Return the view of one of the cameras, where so many pixels beside each other may share one colour."""
    yaw, pitch = cameras.yaws[image], cameras.pitches[image]
    eye = (cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2])
    pixel = 2.0 * cameras.half_width / width
    left, top = (0.5 - 0.5 * width) * pixel, (0.5 * height - 0.5) * pixel
    least = 1.0 / np.sqrt(1.0 + left * left + top * top)
    directions = sine(yaw), cosine(yaw), sine(pitch), cosine(pitch)
    return View(eye, *directions, pixel, shared * pixel, left, top, height, width, least)


@lru_cache(maxsize=4)
def cosines_of(half_width: float, height: int, width: int) -> NDArray[np.float32]:
    """Return (H, W) the cosines of the angles between the view axis and the rays."""
    pixel = 2.0 * half_width / width
    right = (np.arange(width) + 0.5 - 0.5 * width) * pixel
    above = (0.5 * height - np.arange(height) - 0.5) * pixel
    return (1.0 / np.sqrt(1.0 + above[:, None] ** 2 + right**2)).astype(np.float32)


@inlined_kernel
def footprint(view: View, direction: Vector, distance: float, normal: Vector) -> float:
    """Return the size in m, on a surface, of the pixels that share one colour."""
    return view.detail * distance / max(LEAST_FACING, -dot(direction, normal))


class Vectors(NamedTuple):
    """A unit vector for each pixel of a row, (W,) each."""

    east: NDArray[np.float32]
    up: NDArray[np.float32]
    north: NDArray[np.float32]


@inlined_kernel
def vector_at(vectors: Vectors, column: int) -> Vector:
    """Return one of the vectors of a row."""
    return float(vectors.east[column]), float(vectors.up[column]), float(vectors.north[column])


@inlined_kernel
def vectors_in(vectors: Vectors, first: int, last: int) -> Vectors:
    """Return the vectors of the columns from ``first`` to before ``last``."""
    return Vectors(vectors.east[first:last], vectors.up[first:last], vectors.north[first:last])


@inlined_kernel
def write_directions(
    view: View, row: int, columns: NDArray[np.int32], cosines: NDArray[np.float32], ways: Vectors
) -> None:
    """Write the rays of some columns of a row, given the cosines of their angles to the view axis."""
    above = view.top - row * view.pixel
    level = np.float32(view.cos_pitch + view.sin_pitch * above)
    rise = np.float32(view.cos_pitch * above - view.sin_pitch)
    sin_yaw, cos_yaw = np.float32(view.sin_yaw), np.float32(view.cos_yaw)
    left, pixel = np.float32(view.left), np.float32(view.pixel)
    for column in range(cosines.shape[0]):
        right = left + pixel * np.float32(columns[column])
        ways.east[column] = (sin_yaw * level + cos_yaw * right) * cosines[column]
        ways.up[column] = rise * cosines[column]
        ways.north[column] = (cos_yaw * level - sin_yaw * right) * cosines[column]


@kernel
def point_along(eye: Vector, direction: Vector, distance: float) -> Vector:
    """Return the place at a distance in m along a ray."""
    return (
        eye[0] + direction[0] * distance,
        eye[1] + direction[1] * distance,
        eye[2] + direction[2] * distance,
    )


class Channels(NamedTuple):
    """Red, green and blue of a row, 0-255, (W,) each."""

    red: NDArray[np.float32]
    green: NDArray[np.float32]
    blue: NDArray[np.float32]


@inlined_kernel
def channels_in(channels: Channels, first: int, last: int) -> Channels:
    """Return the colours of the columns from ``first`` to before ``last``."""
    return Channels(channels.red[first:last], channels.green[first:last], channels.blue[first:last])


class Tilts(NamedTuple):
    """The planes of the surfaces of a row on the camera's axes, (W,) each."""

    right: NDArray[np.float32]  # parts of the normals
    above: NDArray[np.float32]
    facing: NDArray[np.float32]  # m of a plane from the eye per m along the view axis


class Places(NamedTuple):
    """Where rays to the light start, slightly off the surfaces of a row, (W,) m each."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    z: NDArray[np.float32]


@inlined_kernel
def place_at(places: Places, column: int) -> Vector:
    """Return one of the places of a row."""
    return float(places.x[column]), float(places.y[column]), float(places.z[column])


class RowOfPixels(NamedTuple):
    """What is computed for one row of pixels, (W,) each."""

    ways: Vectors  # of the rays
    color: Channels  # of the surfaces, first without light, then without haze
    normal: Vectors  # of the surfaces
    tilt: Tilts
    place: Places
    unoccluded: NDArray[np.float32]  # share of the light from the sky that nearby surfaces leave
    unoccluded_above: NDArray[np.float32]  # the same in the row above
    ambient: NDArray[np.float32]  # light on surfaces from the sky
    direct: NDArray[np.float32]  # light on surfaces from the sun
    fog: NDArray[np.float32]  # share of the haze in the final colour
    level: NDArray[np.float32]  # how near rays are to the horizon, 0-1


def allocate_rows(width: int) -> NDArray[np.float32]:
    """Return uninitialized space for a row of pixels and what it needs of the one above."""
    return np.empty((ROWS, width), np.float32)


class TracedRow(NamedTuple):
    """A row of an image to be shaded: what its rays hit, and what is computed for its pixels."""

    camera: View
    hit: Hits  # of the whole image, (H, W) each
    number: int  # of the row
    line: Hits  # of the pixels of the row that are shaded, (W,) each
    pieces: NDArray[np.int32]  # (W + 1,) the first column of each piece that shows one surface, then W
    piece_count: int
    pixels: RowOfPixels


@inlined_kernel
def row_in(space: NDArray[np.float32], row: int, count: int) -> RowOfPixels:
    """Return the arrays of so many pixels of a row."""
    this, above = UNOCCLUDED + (row & 1), UNOCCLUDED + 1 - (row & 1)
    return RowOfPixels(
        Vectors(space[0, :count], space[1, :count], space[2, :count]),
        Channels(space[COLOR, :count], space[COLOR + 1, :count], space[COLOR + 2, :count]),
        Vectors(space[NORMAL, :count], space[NORMAL + 1, :count], space[NORMAL + 2, :count]),
        Tilts(space[TILT, :count], space[TILT + 1, :count], space[TILT + 2, :count]),
        Places(space[PLACE, :count], space[PLACE + 1, :count], space[PLACE + 2, :count]),
        space[this, :count],
        space[above, :count],
        space[OTHERS, :count],
        space[OTHERS + 1, :count],
        space[OTHERS + 2, :count],
        space[OTHERS + 3, :count],
    )


class TextureScratch(NamedTuple):
    """Buffers for the textures along a row, (AT_ONCE,) each."""

    x: NDArray[np.float32]  # m
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    pixel: NDArray[np.float32]  # m, size on the surface
    grain: NDArray[np.float32]  # brightness
    seen: NDArray[np.float32]  # how visible details of one size are
    east: NDArray[np.float32]  # position in a cell, or among the numbers of the noise, 0-1
    north: NDArray[np.float32]
    rise: NDArray[np.float32]  # position between two levels of the noise, 0-1
    row: NDArray[np.int32]  # of the cell
    column: NDArray[np.int32]
    corner: NDArray[np.int32]  # index in ``noise.FOURS``, then what is there
    corner_above: NDArray[np.int32]  # the same in the level above


def allocate_texture_scratch() -> TextureScratch:
    """Return buffers of zeros, because some loops also read a few numbers that nobody has written."""
    floats = np.zeros((FLOATS, AT_ONCE), np.float32)
    return TextureScratch(*floats, *np.zeros((len(TextureScratch._fields) - FLOATS, AT_ONCE), np.int32))


@disjoint_kernel
def write_places(view: View, ways: Vectors, distances: NDArray[np.float32], scratch: TextureScratch) -> None:
    """Write where the pixels of a piece of a row show something."""
    x, y, z = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    for column in range(distances.shape[0]):
        scratch.x[column] = x + ways.east[column] * distances[column]
        scratch.y[column] = y + ways.up[column] * distances[column]
        scratch.z[column] = z + ways.north[column] * distances[column]


@disjoint_kernel
def write_footprints(
    view: View, ways: Vectors, distances: NDArray[np.float32], normal: Vectors, scratch: TextureScratch
) -> None:
    """Write the sizes of pixels on surfaces with these normals, as ``footprint`` does."""
    pixel = np.float32(view.detail)
    for column in range(distances.shape[0]):
        away = ways.east[column] * normal.east[column] + ways.up[column] * normal.up[column]
        facing = -(away + ways.north[column] * normal.north[column])
        scratch.pixel[column] = pixel * distances[column] / max(LEAST_FACING_32, facing)
