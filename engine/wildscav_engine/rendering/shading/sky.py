"""The sky: a gradient, the sun's disc, a few clouds, and the haze that distant surfaces fade into."""

import math

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.rendering.palette import SUN
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.noise import noise

ZENITH, HORIZON = (84.0, 138.0, 206.0), (200.0, 217.0, 232.0)
BELOW = (168.0, 182.0, 192.0)  # below the horizon, beyond the edge of the map
SUN_COLOR, CLOUD = (255.0, 247.0, 222.0), (240.0, 243.0, 247.0)
_LENGTH = math.sqrt(sum(float(part) * float(part) for part in SUN))
SUN_DIRECTION = (
    float(SUN[0]) / _LENGTH,
    float(SUN[1]) / _LENGTH,
    float(SUN[2]) / _LENGTH,
)  # unit vector to the sun
DISC, GLOW = 0.9994, 0.97  # cosines of the angles from the sun's centre where its disc and its glow end


@kernel
def haze(direction: Vector) -> Color:
    """Return the colour of the clear sky along a unit vector, without the sun."""
    if direction[1] < 0.0:
        return mixed(HORIZON, BELOW, clipped(-2.5 * direction[1], 0.0, 1.0))
    rest = 1.0 - min(1.0, direction[1])
    return mixed(ZENITH, HORIZON, rest * rest * rest * rest)


@kernel
def sky(direction: Vector) -> Color:
    """Return the colour of the sky along a unit vector."""
    color = haze(direction)
    if direction[1] > 0.04:
        color = mixed(color, CLOUD, _cloud(direction))
    to_sun = dot(direction, SUN_DIRECTION)
    if to_sun > GLOW:
        glow = (to_sun - GLOW) / (1.0 - GLOW)
        color = mixed(color, SUN_COLOR, 1.0 if to_sun > DISC else 0.7 * glow * glow)
    return color


@kernel
def _cloud(direction: Vector) -> float:
    """Return the cloud cover, 0-1: noise on a plane high above, thinner towards the horizon."""
    x, z = 1.6 * direction[0] / (direction[1] + 0.12), 1.6 * direction[2] / (direction[1] + 0.12)
    cover = 0.56 * noise(x, z) + 0.29 * noise(2.1 * x + 9.0, 2.1 * z) + 0.15 * noise(4.3 * x, 4.3 * z + 5.0)
    return 0.75 * clipped((cover - 0.50) * 3.2, 0.0, 1.0) * clipped((direction[1] - 0.04) * 6.0, 0.0, 1.0)
