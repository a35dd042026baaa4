"""The sky: a gradient, the sun's disc, a few clouds, and the haze that all that is far fades into."""

import math

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.rendering.palette import SUN
from wildscav_engine.rendering.shading.color_sums import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.noise import noise

ZENITH, HORIZON = (84.0, 138.0, 206.0), (200.0, 217.0, 232.0)
BELOW = (168.0, 182.0, 192.0)  # beyond the edge of the map, far down
SUN_COLOR, CLOUD = (255.0, 247.0, 222.0), (240.0, 243.0, 247.0)
_LENGTH = math.sqrt(sum(float(part) * float(part) for part in SUN))
SUN_WAY = (
    float(SUN[0]) / _LENGTH,
    float(SUN[1]) / _LENGTH,
    float(SUN[2]) / _LENGTH,
)  # unit vector to the sun
DISC, GLOW = 0.9994, 0.97  # cosines of the angles from its middle at which the disc and its glow end


@kernel
def haze(way: Vector) -> Color:
    """Return the colour of the clear sky along a unit vector, the sun left out."""
    if way[1] < 0.0:
        return mixed(HORIZON, BELOW, clipped(-2.5 * way[1], 0.0, 1.0))
    rest = 1.0 - min(1.0, way[1])
    return mixed(ZENITH, HORIZON, rest * rest * rest * rest)


@kernel
def sky(way: Vector) -> Color:
    """Return the colour of the sky along a unit vector."""
    color = haze(way)
    if way[1] > 0.04:
        color = mixed(color, CLOUD, _cloud(way))
    to_sun = dot(way, SUN_WAY)
    if to_sun > GLOW:
        glow = (to_sun - GLOW) / (1.0 - GLOW)
        color = mixed(color, SUN_COLOR, 1.0 if to_sun > DISC else 0.7 * glow * glow)
    return color


@kernel
def _cloud(way: Vector) -> float:
    """Return how much cloud there is, 0-1: noise on a plane high above, thinner towards the horizon."""
    x, z = 1.6 * way[0] / (way[1] + 0.12), 1.6 * way[2] / (way[1] + 0.12)
    cover = 0.56 * noise(x, z) + 0.29 * noise(2.1 * x + 9.0, 2.1 * z) + 0.15 * noise(4.3 * x, 4.3 * z + 5.0)
    return 0.75 * clipped((cover - 0.50) * 3.2, 0.0, 1.0) * clipped((way[1] - 0.04) * 6.0, 0.0, 1.0)
