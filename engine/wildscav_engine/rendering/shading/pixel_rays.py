"""The rays of one camera's pixels, the same as those of ``trace``."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.shading.color_arithmetic import Vector, dot

LEAST_FACING = 0.2  # cosine between a normal and the way to the eye; pixels are no longer at flatter angles


class View(NamedTuple):
    """One camera and its image size."""

    eye: Vector  # m
    sin_yaw: float
    cos_yaw: float
    sin_pitch: float
    cos_pitch: float
    pixel: float  # side of a pixel at distance 1 m along the axis, m
    left: float  # tangent of the angle to the right of the view axis of the first column's pixels
    top: float  # the same upwards of the first row
    height: int  # pixels
    width: int


@kernel
def view_of(cameras: Cameras, image: int, height: int, width: int) -> View:
    """Return the view of one of the cameras."""
    yaw, pitch = cameras.yaws[image], cameras.pitches[image]
    eye = (cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2])
    pixel = 2.0 * cameras.half_width / width
    left, top = (0.5 - 0.5 * width) * pixel, (0.5 * height - 0.5) * pixel
    return View(eye, sine(yaw), cosine(yaw), sine(pitch), cosine(pitch), pixel, left, top, height, width)


@kernel
def direction_of(view: View, row: int, column: int) -> Vector:
    """Return the unit vector of a pixel's ray."""
    up = (view.height * 0.5 - row - 0.5) * view.pixel
    right = (column + 0.5 - view.width * 0.5) * view.pixel
    level, rise = view.cos_pitch + view.sin_pitch * up, view.cos_pitch * up - view.sin_pitch
    along = 1.0 / np.sqrt(1.0 + up * up + right * right)
    return (
        (view.sin_yaw * level + view.cos_yaw * right) * along,
        rise * along,
        (view.cos_yaw * level - view.sin_yaw * right) * along,
    )


@lru_cache(maxsize=4)
def cosines_of(half_width: float, height: int, width: int) -> NDArray[np.float32]:
    """Return (H, W) the cosines of the angles between the view axis and the rays."""
    pixel = 2.0 * half_width / width
    right = (np.arange(width) + 0.5 - 0.5 * width) * pixel
    above = (0.5 * height - np.arange(height) - 0.5) * pixel
    return (1.0 / np.sqrt(1.0 + above[:, None] ** 2 + right**2)).astype(np.float32)


@inlined_kernel
def footprint(view: View, direction: Vector, distance: float, normal: Vector) -> float:
    """Return the size in m of a pixel on a surface."""
    return view.pixel * distance / max(LEAST_FACING, -dot(direction, normal))


class Ways(NamedTuple):
    """The unit vectors of the rays of one row of pixels, (W,) each."""

    east: NDArray[np.float32]
    up: NDArray[np.float32]
    north: NDArray[np.float32]


@inlined_kernel
def write_ways(view: View, row: int, cosines: NDArray[np.float32], ways: Ways) -> None:
    """Write the rays of a row, given (W,) the cosines of their angles to the view axis."""
    above = view.top - row * view.pixel
    level = np.float32(view.cos_pitch + view.sin_pitch * above)
    rise = np.float32(view.cos_pitch * above - view.sin_pitch)
    sin_yaw, cos_yaw = np.float32(view.sin_yaw), np.float32(view.cos_yaw)
    left, pixel = np.float32(view.left), np.float32(view.pixel)
    for column in range(cosines.shape[0]):
        right = left + pixel * np.float32(np.int32(column))
        ways.east[column] = (sin_yaw * level + cos_yaw * right) * cosines[column]
        ways.up[column] = rise * cosines[column]
        ways.north[column] = (cos_yaw * level - sin_yaw * right) * cosines[column]


@inlined_kernel
def way_of(ways: Ways, column: int) -> Vector:
    """Return the unit vector of one ray of a row."""
    return float(ways.east[column]), float(ways.up[column]), float(ways.north[column])


@kernel
def point_along(eye: Vector, direction: Vector, distance: float) -> Vector:
    """Return the place at a distance in m along a ray."""
    return (
        eye[0] + direction[0] * distance,
        eye[1] + direction[1] * distance,
        eye[2] + direction[2] * distance,
    )
