"""The sky: a gradient, the sun's disc, a few clouds, and the haze that distant surfaces fade into.

The sky of a row of pixels is written in loops that vectorize.
"""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.palette import SUN
from wildscav_engine.rendering.shading.noise import endless_noise
from wildscav_engine.rendering.shading.pixel_rows import (
    AT_ONCE,
    Channels,
    RowOfPixels,
    TextureScratch,
    Vectors,
    vectors_in,
)
from wildscav_engine.rendering.tracing.frustum import nonnegative

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
NONE, HALF, ONE, MOST = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(255.0)
LEAST = np.float32(1e-6)
WIDTH, FROM, FLAT = np.float32(CLOUDS_WIDTH), np.float32(CLOUDS_FROM), np.float32(FLATTENED)
REACH, PER_STEP, INTO = np.float32(CLOUDS_REACH), np.float32(1.0 / CLOUDS_STEP), np.float32(INTO_CLOUDS)
GLOW_32, PER_GLOW, DISC_32 = np.float32(GLOW), np.float32(1.0 / (1.0 - GLOW)), np.float32(DISC)
STRENGTH = np.float32(GLOW_STRENGTH)
SUN_EAST, SUN_UP, SUN_NORTH = (np.float32(part) for part in SUN_DIRECTION)
OF_CLOUDS = tuple(np.float32(part) for part in CLOUD)
TO_SUN = tuple(np.float32(sun - cloud) for sun, cloud in zip(SUN_COLOR, CLOUD, strict=True))
STEEPLY = np.float32(-2.5)
OF_ZENITH = tuple(np.float32(part) for part in ZENITH)
TO_HORIZON = tuple(np.float32(far - high) for far, high in zip(HORIZON, ZENITH, strict=True))
TO_BELOW = tuple(np.float32(low - far) for low, far in zip(BELOW, HORIZON, strict=True))


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
            clouds[row, column] = 0.75 * min(1.0, max(0.0, (cover - 0.50) * 3.2))


@inlined_kernel
def levelness(up: np.float32) -> np.float32:
    """Return how near a ray is to the horizon, 0-1, given the upward part of its unit vector."""
    rest = ONE - max(NONE, up)
    return np.float32(rest * rest * rest * rest)


@inlined_kernel
def haze(channel: int, up: np.float32, level: np.float32) -> np.float32:
    """Return the colour of the clear sky along a ray, without the sun; ``level`` is its ``levelness``."""
    low = min(ONE, max(NONE, STEEPLY * up))
    return np.float32(OF_ZENITH[channel] + TO_HORIZON[channel] * level + TO_BELOW[channel] * low)


@inlined_kernel
def write_fog(distances: NDArray[np.float32], far: float, fog: NDArray[np.float32]) -> None:
    """Write the shares of the haze, given m along the rays of a row; they are 1 beyond ``far``."""
    nearness = np.float32(1.0 / far)
    for column in range(fog.shape[0]):
        part = min(ONE, distances[column] * nearness)
        fog[column] = part * part


@inlined_kernel
def add_haze(pixels: RowOfPixels) -> None:
    """Blend the colours of a row with the haze of the open air."""
    up, level = pixels.ways.up, pixels.level
    for column in range(level.shape[0]):
        level[column] = levelness(up[column])
    _blend_haze(pixels.color.red, level, up, pixels.fog, 0)
    _blend_haze(pixels.color.green, level, up, pixels.fog, 1)
    _blend_haze(pixels.color.blue, level, up, pixels.fog, 2)


@inlined_kernel
def _blend_haze(
    own: NDArray[np.float32],
    level: NDArray[np.float32],
    up: NDArray[np.float32],
    fog: NDArray[np.float32],
    channel: int,
) -> None:
    """Blend one channel of a row with the haze in each direction."""
    for column in range(own.shape[0]):
        own[column] = blended(own[column], haze(channel, up[column], level[column]), fog[column])


@inlined_kernel
def blended(own: np.float32, other: np.float32, share: np.float32) -> np.float32:
    """Return the blend of two brightnesses, by the share of the other, to be rounded down, 0-255."""
    return min(MOST, max(NONE, own + (other - own) * share + HALF))


@inlined_kernel
def write_sky(
    ways: Vectors,
    clouds: NDArray[np.float32],
    scratch: TextureScratch,
    shown: Channels,
    fog: NDArray[np.float32],
) -> None:
    """Write what is before the clear sky, and how much of the haze is seen, in a piece of a row."""
    for start in range(0, fog.shape[0], AT_ONCE):
        end = min(fog.shape[0], start + AT_ONCE)
        some = vectors_in(ways, start, end)
        _place_in_clouds(some, np.float32(clouds.shape[0] - 2), scratch)
        for column in range(end - start):
            row, first = nonnegative(scratch.row[column]), nonnegative(scratch.column[column])
            east, south, north = scratch.east[column], clouds[row], clouds[row + 1]
            low = south[first] + (south[first + 1] - south[first]) * east
            high = north[first] + (north[first + 1] - north[first]) * east
            scratch.seen[column] *= low + (high - low) * scratch.north[column]
        _write_glow(some, scratch, fog[start:end])
        _write_channel(0, scratch, shown.red[start:end])
        _write_channel(1, scratch, shown.green[start:end])
        _write_channel(2, scratch, shown.blue[start:end])


@disjoint_kernel
def _place_in_clouds(ways: Vectors, last: np.float32, scratch: TextureScratch) -> None:
    """Write where rays meet the clouds, and how much of these is seen there: less towards the horizon."""
    for column in range(ways.up.shape[0]):
        up = ways.up[column]
        scratch.seen[column] = min(ONE, max(NONE, (up - FROM) * INTO))
        scale = WIDTH / (max(FROM, up) + FLAT)
        x, z = (ways.east[column] * scale + REACH) * PER_STEP, (ways.north[column] * scale + REACH) * PER_STEP
        west, south = min(last, max(NONE, np.floor(x))), min(last, max(NONE, np.floor(z)))
        scratch.column[column], scratch.row[column] = np.int32(west), np.int32(south)
        scratch.east[column], scratch.north[column] = x - west, z - south


@disjoint_kernel
def _write_glow(ways: Vectors, scratch: TextureScratch, fog: NDArray[np.float32]) -> None:
    """Write the shares of the haze, and of the sun in what is before it."""
    for column in range(fog.shape[0]):
        to_sun = ways.east[column] * SUN_EAST + ways.up[column] * SUN_UP + ways.north[column] * SUN_NORTH
        near = max(NONE, (to_sun - GLOW_32) * PER_GLOW)
        glow = ONE if to_sun > DISC_32 else STRENGTH * near * near
        rest = (ONE - scratch.seen[column]) * (ONE - glow)
        fog[column] = rest
        scratch.grain[column] = glow / max(LEAST, ONE - rest)


@disjoint_kernel
def _write_channel(channel: int, scratch: TextureScratch, shown: NDArray[np.float32]) -> None:
    cloud, to_sun = OF_CLOUDS[channel], TO_SUN[channel]
    for column in range(shown.shape[0]):
        shown[column] = cloud + to_sun * scratch.grain[column]
