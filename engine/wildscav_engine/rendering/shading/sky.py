"""The sky: a gradient, the sun's disc, a few clouds, and the haze that distant surfaces fade into."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.palette import SUN
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.noise import endless_noise

ZENITH, HORIZON = (84.0, 138.0, 206.0), (200.0, 217.0, 232.0)
BELOW = (168.0, 182.0, 192.0)  # below the horizon, beyond the edge of the map
SUN_COLOR, CLOUD = (255.0, 247.0, 222.0), (240.0, 243.0, 247.0)
_LENGTH = math.sqrt(sum(float(part) * float(part) for part in SUN))
SUN_DIRECTION = (
    float(SUN[0]) / _LENGTH,
    float(SUN[1]) / _LENGTH,
    float(SUN[2]) / _LENGTH,
)  # unit vector to the sun
CLOUDS_FROM = 0.04  # sine of the elevation above which there are clouds
FLATTENED = 0.12  # added to that sine, so that clouds do not shrink without end towards the horizon
INTO_CLOUDS = 6.0  # how soon they are all there, per unit of that sine
CLOUDS_WIDTH = 1.6  # scale of the plane that they are drawn on
CLOUDS_REACH = 10.0  # greatest coordinate of a cloud, on that plane
CLOUDS_STEP = 0.0625  # between two numbers of the clouds' map
DISC, GLOW = 0.9994, 0.97  # cosines of the angles from the sun's centre where its disc and its glow end
GLOW_STRENGTH = 0.7  # next to the disc


@kernel
def haze(direction: Vector) -> Color:
    """Return the colour of the clear sky along a unit vector, without the sun."""
    if direction[1] < 0.0:
        return mixed(HORIZON, BELOW, clipped(-2.5 * direction[1], 0.0, 1.0))
    rest = 1.0 - min(1.0, direction[1])
    return mixed(ZENITH, HORIZON, rest * rest * rest * rest)


@inlined_kernel
def sky(direction: Vector, clouds: NDArray[np.float32]) -> Color:
    """Return the colour of the sky along a unit vector, given the map of the clouds."""
    color = haze(direction)
    if direction[1] > CLOUDS_FROM:
        color = mixed(color, CLOUD, _cloud(direction, clouds))
    to_sun = dot(direction, SUN_DIRECTION)
    if to_sun > GLOW:
        color = mixed(color, SUN_COLOR, _glow(to_sun))
    return color


@inlined_kernel
def _glow(to_sun: float) -> float:
    """Return how much the sun outshines the sky, by the cosine of the angle to its centre."""
    glow = (to_sun - GLOW) / (1.0 - GLOW)
    return 1.0 if to_sun > DISC else GLOW_STRENGTH * glow * glow


@inlined_kernel
def _cloud(direction: Vector, clouds: NDArray[np.float32]) -> float:
    """Return how much of the sky clouds cover, 0-1, less towards the horizon."""
    scale = CLOUDS_WIDTH / (direction[1] + FLATTENED)
    x = (direction[0] * scale + CLOUDS_REACH) * (1.0 / CLOUDS_STEP)
    z = (direction[2] * scale + CLOUDS_REACH) * (1.0 / CLOUDS_STEP)
    last = clouds.shape[0] - 2
    column, row = min(last, max(0, int(x))), min(last, max(0, int(z)))
    east, north = x - column, z - row
    south = clouds[row, column] + (clouds[row, column + 1] - clouds[row, column]) * east
    top = clouds[row + 1, column] + (clouds[row + 1, column + 1] - clouds[row + 1, column]) * east
    cover = float(south + (top - south) * north)
    return cover * clipped((direction[1] - CLOUDS_FROM) * INTO_CLOUDS, 0.0, 1.0)


@cache
def clouds() -> NDArray[np.float32]:
    """Return (N, N) how much clouds cover, 0-1, on a plane high above, from south-west to north-east."""
    count = int(2.0 * CLOUDS_REACH / CLOUDS_STEP) + 2
    cover = np.empty((count, count), np.float32)
    _write_clouds(cover)
    return cover


@kernel
def _write_clouds(clouds: NDArray[np.float32]) -> None:
    for row in range(clouds.shape[0]):
        for column in range(clouds.shape[1]):
            x, z = column * CLOUDS_STEP - CLOUDS_REACH, row * CLOUDS_STEP - CLOUDS_REACH
            wide, fine = endless_noise(x, z), endless_noise(4.3 * x, 4.3 * z + 5.0)
            cover = 0.56 * wide + 0.29 * endless_noise(2.1 * x + 9.0, 2.1 * z) + 0.15 * fine
            clouds[row, column] = 0.75 * clipped((cover - 0.50) * 3.2, 0.0, 1.0)
