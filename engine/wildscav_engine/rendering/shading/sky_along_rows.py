"""The sky along a row of pixels: that of ``sky``, in loops that vectorize."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.rendering.shading.pixel_rays import Ways
from wildscav_engine.rendering.shading.pixel_rows import Channels
from wildscav_engine.rendering.shading.sky import (
    CLOUD,
    CLOUDS_FROM,
    CLOUDS_REACH,
    CLOUDS_STEP,
    CLOUDS_WIDTH,
    DISC,
    FLATTENED,
    GLOW,
    GLOW_STRENGTH,
    INTO_CLOUDS,
    SUN_COLOR,
    SUN_DIRECTION,
)
from wildscav_engine.rendering.shading.texture_scratch import AT_ONCE, TextureScratch
from wildscav_engine.rendering.tracing.frustum import nonnegative

NONE, ONE, LEAST = np.float32(0.0), np.float32(1.0), np.float32(1e-6)
WIDTH, FROM, FLAT = np.float32(CLOUDS_WIDTH), np.float32(CLOUDS_FROM), np.float32(FLATTENED)
REACH, PER_STEP, INTO = np.float32(CLOUDS_REACH), np.float32(1.0 / CLOUDS_STEP), np.float32(INTO_CLOUDS)
GLOW_32, PER_GLOW, DISC_32 = np.float32(GLOW), np.float32(1.0 / (1.0 - GLOW)), np.float32(DISC)
STRENGTH = np.float32(GLOW_STRENGTH)
SUN_EAST, SUN_UP, SUN_NORTH = (np.float32(part) for part in SUN_DIRECTION)
OF_CLOUDS = tuple(np.float32(part) for part in CLOUD)
TO_SUN = tuple(np.float32(sun - cloud) for sun, cloud in zip(SUN_COLOR, CLOUD, strict=True))


@inlined_kernel
def write_sky(
    ways: Ways,
    clouds: NDArray[np.float32],
    scratch: TextureScratch,
    shown: Channels,
    fog: NDArray[np.float32],
) -> None:
    """Write what is before the clear sky, and how much of the haze is seen, in a piece of a row of C pixels.

    Args:
        shown: (C,) written.
        fog: (C,) written.
    """
    for start in range(0, fog.shape[0], AT_ONCE):
        end = min(fog.shape[0], start + AT_ONCE)
        some = Ways(ways.east[start:end], ways.up[start:end], ways.north[start:end])
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
def _place_in_clouds(ways: Ways, last: np.float32, scratch: TextureScratch) -> None:
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
def _write_glow(ways: Ways, scratch: TextureScratch, fog: NDArray[np.float32]) -> None:
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
