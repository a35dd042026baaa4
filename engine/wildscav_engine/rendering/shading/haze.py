"""What is between the eye and a surface: haze in the open air, murk under water."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.shading.pixel_rows import RowOfPixels
from wildscav_engine.rendering.shading.sky import BELOW, HORIZON, ZENITH
from wildscav_engine.rendering.shading.water import DEEP, MURK

NONE, HALF, ONE, MOST = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(255.0)
# The numbers of ``sky.haze`` in float32.
STEEPLY = np.float32(-2.5)
CLEAR_SKY = (np.float32(ZENITH[0]), np.float32(ZENITH[1]), np.float32(ZENITH[2]))
TO_HORIZON = tuple(np.float32(far - high) for far, high in zip(HORIZON, ZENITH, strict=True))
TO_BELOW = tuple(np.float32(low - far) for low, far in zip(BELOW, HORIZON, strict=True))
DEEP_WATER = (np.float32(DEEP[0]), np.float32(DEEP[1]), np.float32(DEEP[2]))
MURKINESS = np.float32(1.0 / MURK)

# Short loops over few arrays, which the compiler can vectorize.


@inlined_kernel
def write_fog(distances: NDArray[np.float32], far: float, fog: NDArray[np.float32]) -> None:
    """Write the shares of the haze, given m along the rays of a row; they are 1 beyond ``far``."""
    nearness = np.float32(1.0 / far)
    for column in range(fog.shape[0]):
        part = min(ONE, distances[column] * nearness)
        fog[column] = part * part


@inlined_kernel
def write_hazy(pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row, with the haze of the open air."""
    up, level = pixels.ways.up, pixels.level
    for column in range(colors.shape[0]):
        rest = ONE - max(NONE, up[column])
        level[column] = rest * rest * rest * rest
    _blend_haze(pixels.color.red, level, up, pixels.fog, 0)
    _blend_haze(pixels.color.green, level, up, pixels.fog, 1)
    _blend_haze(pixels.color.blue, level, up, pixels.fog, 2)
    _write_colors(pixels, colors)


@inlined_kernel
def _blend_haze(
    own: NDArray[np.float32],
    level: NDArray[np.float32],
    up: NDArray[np.float32],
    fog: NDArray[np.float32],
    channel: int,
) -> None:
    """Blend one channel of a row with the haze in each direction; it is ``sky.haze`` without branches."""
    high, to_horizon, to_below = CLEAR_SKY[channel], TO_HORIZON[channel], TO_BELOW[channel]
    for column in range(own.shape[0]):
        low = min(ONE, max(NONE, STEEPLY * up[column]))
        haze = high + to_horizon * level[column] + to_below * low
        own[column] = _rounded(own[column], haze, fog[column])


@inlined_kernel
def write_murky(distances: NDArray[np.float32], pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row, as seen through water."""
    red, green, blue = pixels.color
    for column in range(colors.shape[0]):
        share = min(ONE, distances[column] * MURKINESS)
        red[column] = _rounded(red[column], DEEP_WATER[0], share)
        green[column] = _rounded(green[column], DEEP_WATER[1], share)
        blue[column] = _rounded(blue[column], DEEP_WATER[2], share)
    _write_colors(pixels, colors)


@inlined_kernel
def _rounded(own: np.float32, other: np.float32, share: np.float32) -> np.float32:
    """Return the blend of two brightnesses, by the share of the other, to be rounded down, 0-255."""
    return min(MOST, max(NONE, own + (other - own) * share + HALF))


@inlined_kernel
def _write_colors(pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    red, green, blue = pixels.color
    for column in range(colors.shape[0]):
        colors[column, 0] = np.int32(red[column])
        colors[column, 1] = np.int32(green[column])
        colors[column, 2] = np.int32(blue[column])
