"""Deterministic noise for the grain of surfaces in pictures, and how much of its details pixels show."""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel

LOW_32 = 0xFFFFFFFF
PERIOD = 128  # after which smooth noise repeats; a power of two
BYTE, PER_BYTE = np.int32(255), np.float32(1.0 / 255.0)
BEYOND = 2.0**20  # a multiple of the period that no coordinate of a map exceeds
NONE, ONE, TWO, THREE = (np.float32(number) for number in (0.0, 1.0, 2.0, 3.0))
# How visible details are: SHARPEST less BLUR times the size of a pixel, in sizes of the details.
SHARPEST, BLUR = 1.6, 2.4
SHARPEST_32, BLUR_32 = np.float32(SHARPEST), np.float32(BLUR)
FACTORS = (374761393, 668265263, 974634533, 1274126177)


@kernel
def grain(x: int, y: int, z: int) -> float:
    """Return a pseudo-random number in [0, 1) for a point of the integer lattice."""
    mixed = x * FACTORS[0] + y * FACTORS[1] + z * FACTORS[2] & LOW_32
    mixed = (mixed ^ mixed >> 13) * FACTORS[3] & LOW_32
    return (mixed ^ mixed >> 16) / 4294967296.0


def _lattice() -> NDArray[np.int64]:
    """Return (129, 129) ``grain`` at each row and column, 0-255, repeated after 128."""
    at = np.arange(PERIOD + 1) % PERIOD
    mixed = at[None, :] * FACTORS[0] + at[:, None] * FACTORS[1] & LOW_32
    mixed = (mixed ^ mixed >> 13) * FACTORS[3] & LOW_32
    return (mixed ^ mixed >> 16) >> 24


def _fours(lattice: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return (128 * 128,) what is needed between four numbers of the lattice, packed for a single look-up.

    From the lowest byte on: the south-western, the south-eastern, the north-western, the north-eastern one.
    """
    south, north = lattice[:-1], lattice[1:]
    packed = south[:, :-1] | south[:, 1:] << 8 | north[:, :-1] << 16 | north[:, 1:] << 24
    return packed.astype(np.uint32).view(np.int32).ravel()


LATTICE = (_lattice() / 255.0).astype(np.float32)
FOURS = _fours(_lattice())


@kernel
def endless_noise(x: float, z: float) -> float:
    """Return smooth noise in [0, 1) over a plane, with features of length 1, that never repeats."""
    column, row = math.floor(x), math.floor(z)
    east, north = _eased(x - column), _eased(z - row)
    south = grain(column, row, 0) + (grain(column + 1, row, 0) - grain(column, row, 0)) * east
    top = grain(column, row + 1, 0) + (grain(column + 1, row + 1, 0) - grain(column, row + 1, 0)) * east
    return south + (top - south) * north


@kernel
def noise(x: float, z: float) -> float:
    """Return the same from 0 to PERIOD, repeated without end; it takes a fraction of the time."""
    x, z = x + BEYOND, z + BEYOND  # rounding towards zero is quicker than rounding down
    column, row = int(x), int(z)
    east, north = eased32(np.float32(x - column)), eased32(np.float32(z - row))
    c, r = column & PERIOD - 1, row & PERIOD - 1
    south = LATTICE[r, c] + (LATTICE[r, c + 1] - LATTICE[r, c]) * east
    top = LATTICE[r + 1, c] + (LATTICE[r + 1, c + 1] - LATTICE[r + 1, c]) * east
    return float(south + (top - south) * north)


@inlined_kernel
def corner_of(column: int, row: int) -> int:
    """Return where in ``FOURS`` the numbers around a place are, given its coordinates rounded down."""
    return (row & PERIOD - 1) * PERIOD + (column & PERIOD - 1)


@inlined_kernel
def between(four: np.int32, east: np.float32, north: np.float32) -> np.float32:
    """Return ``noise`` between four of its numbers, at a position that is already ``eased32``."""
    west_low, east_low = np.float32(four & BYTE), np.float32(four >> 8 & BYTE)
    west_high, east_high = np.float32(four >> 16 & BYTE), np.float32(four >> 24 & BYTE)
    low = west_low + (east_low - west_low) * east
    high = west_high + (east_high - west_high) * east
    return np.float32((low + (high - low) * north) * PER_BYTE)


@kernel
def _eased(share: float) -> float:
    return share * share * (3.0 - 2.0 * share)


@kernel
def eased32(share: np.float32) -> np.float32:
    """Return a share from 0 to 1 that starts and ends level."""
    return share * share * (THREE - TWO * share)


# Where a size is constant, so are these quotients: the compiler then replaces divisions, which are slow.


@inlined_kernel
def sharpness(size: float, pixel: float) -> float:
    """Return how visible a detail of some size in m is, 0-1, at a pixel size in m."""
    return min(1.0, max(0.0, SHARPEST - pixel * (BLUR / size)))


@inlined_kernel
def sharpness32(size: np.float32, pixel: np.float32) -> np.float32:
    """Do the same in float32."""
    return min(ONE, max(NONE, SHARPEST_32 - pixel * (BLUR_32 / size)))


@disjoint_kernel
def write_seen(
    size: np.float32, strength: np.float32, count: int, pixel: NDArray[np.float32], seen: NDArray[np.float32]
) -> bool:
    """Write how visible details of some size are; return whether any is."""
    is_any = np.int32(0)
    for column in range(count):
        sharp = sharpness32(size, pixel[column])
        seen[column] = strength * sharp
        is_any |= np.int32(sharp > NONE)
    return bool(is_any != 0)
