"""Buffers for the textures along a row of pixels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel

AT_ONCE = 128  # pixels, whose numbers stay in the fastest cache
FLOATS = 9  # buffers of float32; the other ones are int32


class TextureScratch(NamedTuple):
    """Buffers for the textures along a row, (AT_ONCE,) each."""

    x: NDArray[np.float32]  # m
    y: NDArray[np.float32]
    z: NDArray[np.float32]
    pixel: NDArray[np.float32]  # m, size on the surface
    grain: NDArray[np.float32]  # brightness
    seen: NDArray[np.float32]  # how visible details of one size are
    east: NDArray[np.float32]  # position in a cell, or among the numbers of the noise, 0-1
    north: NDArray[np.float32]
    rise: NDArray[np.float32]  # position between two levels of the noise, 0-1
    row: NDArray[np.int32]  # of the cell
    column: NDArray[np.int32]
    corner: NDArray[np.int32]  # index in ``noise.FOURS``, then what is there
    corner_above: NDArray[np.int32]  # the same in the level above


def allocate_texture_scratch() -> TextureScratch:
    """Return buffers of zeros, because some loops also read a few numbers that nobody has written."""
    floats = np.zeros((FLOATS, AT_ONCE), np.float32)
    return TextureScratch(*floats, *np.zeros((len(TextureScratch._fields) - FLOATS, AT_ONCE), np.int32))


@inlined_kernel
def texture_scratch_in(floats: NDArray[np.float32], integers: NDArray[np.int32]) -> TextureScratch:
    """Return the buffers in (FLOATS, AT_ONCE) and (4, AT_ONCE) numbers."""
    return TextureScratch(
        floats[0],
        floats[1],
        floats[2],
        floats[3],
        floats[4],
        floats[5],
        floats[6],
        floats[7],
        floats[8],
        integers[0],
        integers[1],
        integers[2],
        integers[3],
    )
