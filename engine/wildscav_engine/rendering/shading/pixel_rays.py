"""The rays of one camera's pixels, the same as those of ``trace``."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.shading.color_arithmetic import Vector


class View(NamedTuple):
    """One camera and its image size."""

    eye: Vector  # m
    sin_yaw: float
    cos_yaw: float
    sin_pitch: float
    cos_pitch: float
    pixel: float  # side of a pixel at distance 1 m along the axis, m
    height: int  # pixels
    width: int


@kernel
def view_of(cameras: Cameras, image: int, height: int, width: int) -> View:
    """Return the view of one of the cameras."""
    yaw, pitch = cameras.yaws[image], cameras.pitches[image]
    eye = (cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2])
    pixel = 2.0 * cameras.half_width / width
    return View(eye, sine(yaw), cosine(yaw), sine(pitch), cosine(pitch), pixel, height, width)


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


@kernel
def write_directions(view: View, directions: NDArray[np.float64]) -> None:
    """Write (H, W, 3) the unit vectors of all rays."""
    for row in range(view.height):
        for column in range(view.width):
            directions[row, column, 0], directions[row, column, 1], directions[row, column, 2] = direction_of(
                view, row, column
            )


@kernel
def point_along(eye: Vector, direction: Vector, distance: float) -> Vector:
    """Return the place at a distance in m along a ray."""
    return (
        eye[0] + direction[0] * distance,
        eye[1] + direction[1] * distance,
        eye[2] + direction[2] * distance,
    )
