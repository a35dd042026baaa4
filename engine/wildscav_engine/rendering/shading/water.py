"""The appearance of water: the bed seen through it, bluer with depth, and the sky reflected in ripples."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.shading.color_arithmetic import Vector, dot
from wildscav_engine.rendering.shading.ground import write_ground
from wildscav_engine.rendering.shading.light.sunlight import DIRECT
from wildscav_engine.rendering.shading.noise import noise, sharpness
from wildscav_engine.rendering.shading.pixel_rows import (
    AT_ONCE,
    Channels,
    RowOfPixels,
    TextureScratch,
    TracedRow,
    Vectors,
    View,
    footprint,
    point_along,
    vector_at,
    vectors_in,
)
from wildscav_engine.rendering.shading.sky import ONE, SUN_DIRECTION, blended, haze, levelness, write_sky

DEEP = (26.0, 84.0, 132.0)
DEEP_WATER = (np.float32(DEEP[0]), np.float32(DEEP[1]), np.float32(DEEP[2]))
CLEAR = 0.9  # m of depth at which a quarter of the bed's colour is still seen
UP = (0.0, 1.0, 0.0)
WAVES = 0.9  # m from one ripple to the next
STEEPNESS = 0.16  # of ripples
MURK = 9.0  # m, the range of sight under water
MURKINESS = np.float32(1.0 / MURK)
LIT, IN_SHADOW = np.float32(0.4), np.float32(0.6 * DIRECT * SUN_DIRECTION[1])  # water in a shadow keeps 60 %


@inlined_kernel
def write_bed(
    world: World,
    ground: NDArray[np.float32],
    row: TracedRow,
    first: int,
    last: int,
    is_fast: bool,
    scratch: TextureScratch,
) -> None:
    """Write the colours without light, and the normals, of water from one column to before another."""
    write_ground(world, ground, row, first, last, is_fast, scratch)
    pixels, distances = row.pixels, row.line.distance
    for column in range(first, last):
        place = point_along(row.camera.eye, vector_at(pixels.ways, column), float(distances[column]))
        depth = max(0.0, place[1] - ground_at(world, place[0], place[2]).height)
        clear = np.float32(CLEAR / (CLEAR + depth))
        for channel in range(3):
            color, deep = pixels.color[channel], DEEP_WATER[channel]
            color[column] = deep + (color[column] - deep) * clear * clear
            pixels.normal[channel][column] = UP[channel]


@inlined_kernel
def add_murk(distances: NDArray[np.float32], pixels: RowOfPixels) -> None:
    """Blend the colours of a row with the murk under water."""
    red, green, blue = pixels.color
    for column in range(red.shape[0]):
        share = min(ONE, distances[column] * MURKINESS)
        red[column] = blended(red[column], DEEP_WATER[0], share)
        green[column] = blended(green[column], DEEP_WATER[1], share)
        blue[column] = blended(blue[column], DEEP_WATER[2], share)


@inlined_kernel
def lighten(direct: NDArray[np.float32]) -> None:
    """Soften the shadows on water, given the light of the sun on its pixels."""
    for column in range(direct.shape[0]):
        direct[column] = IN_SHADOW + LIT * direct[column]


@inlined_kernel
def write_reflection(
    clouds: NDArray[np.float32], row: TracedRow, first: int, last: int, scratch: TextureScratch
) -> None:
    """Blend the reflected sky into the colours of lit water, from one column to before another.

    The places and the light of these pixels have been used, and are overwritten.
    """
    pixels, place, color = row.pixels, row.pixels.place, row.pixels.color
    for start in range(first, last, AT_ONCE):
        end = min(last, start + AT_ONCE)
        count = end - start
        ways = vectors_in(pixels.ways, start, end)
        mirrored = Vectors(scratch.x[:count], scratch.y[:count], scratch.z[:count])
        sky = Channels(place.x[start:end], place.y[start:end], place.z[start:end])
        share, fog = pixels.ambient[start:end], pixels.direct[start:end]
        _mirror(row.camera, ways, row.line.distance[start:end], mirrored, share)
        write_sky(mirrored, clouds, scratch, sky, fog)
        _reflect(0, mirrored.up, sky.red, fog, share, color.red[start:end])
        _reflect(1, mirrored.up, sky.green, fog, share, color.green[start:end])
        _reflect(2, mirrored.up, sky.blue, fog, share, color.blue[start:end])


@inlined_kernel
def _mirror(
    view: View,
    ways: Vectors,
    distances: NDArray[np.float32],
    mirrored: Vectors,
    share: NDArray[np.float32],
) -> None:
    """Write where rays go that ripples reflect, and the shares of their light.

    Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Eurographics 1994.
    """
    for column in range(share.shape[0]):
        direction, distance = vector_at(ways, column), float(distances[column])
        pixel = footprint(view, direction, distance, UP)
        normal = _rippled(point_along(view.eye, direction, distance), pixel)
        facing = min(1.0, max(0.0, -dot(direction, normal)))
        rest = 1.0 - facing
        share[column] = min(0.75, 0.02 + 0.98 * rest * rest * rest * rest * rest)
        mirrored.east[column] = direction[0] + 2.0 * facing * normal[0]
        mirrored.up[column] = max(0.02, direction[1] + 2.0 * facing * normal[1])
        mirrored.north[column] = direction[2] + 2.0 * facing * normal[2]


@inlined_kernel
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


@inlined_kernel
def _reflect(
    channel: int,
    up: NDArray[np.float32],
    sky: NDArray[np.float32],
    fog: NDArray[np.float32],
    share: NDArray[np.float32],
    own: NDArray[np.float32],
) -> None:
    """Blend one channel of the sky, and of the haze behind it, into the colours of water."""
    for column in range(own.shape[0]):
        clear = haze(channel, up[column], levelness(up[column]))
        seen = sky[column] + (clear - sky[column]) * fog[column]
        own[column] += (seen - own[column]) * share[column]
