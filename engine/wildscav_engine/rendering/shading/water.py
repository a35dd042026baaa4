"""The appearance of water: the bed seen through it, bluer with depth, and the sky reflected in ripples."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dot, mixed
from wildscav_engine.rendering.shading.ground import cell_at, ground_color
from wildscav_engine.rendering.shading.light import lit
from wildscav_engine.rendering.shading.noise import noise
from wildscav_engine.rendering.shading.sky import sky
from wildscav_engine.rendering.shading.surfaces import sharpness

DEEP = (26.0, 84.0, 132.0)
CLEAR = 0.9  # m of depth at which a quarter of the bed's colour is still seen
UP = (0.0, 1.0, 0.0)
WAVES = 0.9  # m from one ripple to the next
STEEPNESS = 0.16  # of ripples
MURK = 9.0  # m, the range of sight under water


@kernel
def water_color(
    world: World,
    ground: NDArray[np.float32],
    clouds: NDArray[np.float32],
    place: Vector,
    direction: Vector,
    sun: float,
    ambient: float,
    pixel: float,
) -> Color:
    """Return the colour of a water surface.

    Args:
        ground: The appearance of its ground; see ``packed_ground``.
        place: m, on the surface.
        direction: Unit vector of the incoming ray.
        sun: Share of the sun's light that reaches it, 0-1.
        ambient: Ambient light, as for ``lit``.
        pixel: m, the size of a pixel there.
    """
    depth = max(0.0, place[1] - ground_at(world, place[0], place[2]).height)
    bed = ground_color(ground, cell_at(world, place[0], place[2]), place, pixel)
    clear = CLEAR / (CLEAR + depth)
    body = lit(mixed(DEEP, bed, clear * clear), UP, 0.6 + 0.4 * sun, ambient)
    normal = _rippled(place, pixel)
    facing = clipped(-dot(direction, normal), 0.0, 1.0)
    # Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Eurographics 1994.
    rest = 1.0 - facing
    reflected = 0.02 + 0.98 * rest * rest * rest * rest * rest
    mirrored = (
        direction[0] + 2.0 * facing * normal[0],
        max(0.02, direction[1] + 2.0 * facing * normal[1]),
        direction[2] + 2.0 * facing * normal[2],
    )
    return mixed(body, sky(mirrored, clouds), min(0.75, reflected))


@kernel
def _rippled(place: Vector, pixel: float) -> Vector:
    """Return the unit normal of a water surface at a place."""
    steep = STEEPNESS * sharpness(WAVES, pixel)
    if steep == 0.0:
        return UP
    x, z = place[0] / WAVES, place[2] / WAVES
    east = steep * (noise(x, 0.6 * z) + 0.6 * noise(2.3 * x, 1.7 * z + 31.0) - 0.8)
    north = steep * (noise(x + 71.0, 0.6 * z) + 0.6 * noise(2.3 * x, 1.7 * z + 93.0) - 0.8)
    length = np.sqrt(1.0 + east * east + north * north)
    return east / length, 1.0 / length, north / length
