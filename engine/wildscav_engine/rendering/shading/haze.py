"""What is between the eye and a surface: haze in the open air, murk under water."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.shading.pixel_rows import RowOfPixels
from wildscav_engine.rendering.shading.sky import haze, levelness
from wildscav_engine.rendering.shading.water import DEEP_WATER, MURK

NONE, HALF, ONE, MOST = np.float32(0.0), np.float32(0.5), np.float32(1.0), np.float32(255.0)
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
        own[column] = _rounded(own[column], haze(channel, up[column], level[column]), fog[column])


@inlined_kernel
def add_murk(distances: NDArray[np.float32], pixels: RowOfPixels) -> None:
    """Blend the colours of a row with the murk under water."""
    red, green, blue = pixels.color
    for column in range(red.shape[0]):
        share = min(ONE, distances[column] * MURKINESS)
        red[column] = _rounded(red[column], DEEP_WATER[0], share)
        green[column] = _rounded(green[column], DEEP_WATER[1], share)
        blue[column] = _rounded(blue[column], DEEP_WATER[2], share)


@inlined_kernel
def _rounded(own: np.float32, other: np.float32, share: np.float32) -> np.float32:
    """Return the blend of two brightnesses, by the share of the other, to be rounded down, 0-255."""
    return min(MOST, max(NONE, own + (other - own) * share + HALF))


@inlined_kernel
def write_colors(pixels: RowOfPixels, colors: NDArray[np.uint8]) -> None:
    """Write (W, 3) the colours of a row."""
    red, green, blue = pixels.color
    for column in range(colors.shape[0]):
        colors[column, 0] = np.int32(red[column])
        colors[column, 1] = np.int32(green[column])
        colors[column, 2] = np.int32(blue[column])
