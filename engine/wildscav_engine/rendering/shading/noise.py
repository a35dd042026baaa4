"""Deterministic noise for the grain of surfaces in pictures."""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel

LOW_32 = 0xFFFFFFFF
PERIOD = 128  # after which smooth noise repeats; a power of two
BEYOND = 2.0**20  # a multiple of the period that no coordinate of a map exceeds
TWO, THREE = np.float32(2.0), np.float32(3.0)
FACTORS = (374761393, 668265263, 974634533, 1274126177)


@kernel
def grain(x: int, y: int, z: int) -> float:
    """Return a pseudo-random number in [0, 1) for a point of the integer lattice."""
    mixed = x * FACTORS[0] + y * FACTORS[1] + z * FACTORS[2] & LOW_32
    mixed = (mixed ^ mixed >> 13) * FACTORS[3] & LOW_32
    return (mixed ^ mixed >> 16) / 4294967296.0


def _lattice() -> NDArray[np.float32]:
    """Return (129, 129) ``grain`` at each row and column, repeated after 128."""
    at = np.arange(PERIOD + 1) % PERIOD
    mixed = at[None, :] * FACTORS[0] + at[:, None] * FACTORS[1] & LOW_32
    mixed = (mixed ^ mixed >> 13) * FACTORS[3] & LOW_32
    return ((mixed ^ mixed >> 16) / 4294967296.0).astype(np.float32)


LATTICE = _lattice()


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


@kernel
def noise_in_space(x: float, y: float, z: float) -> float:
    """Return smooth noise in [0, 1) in space, with features of length 1."""
    level = math.floor(y)
    # Interpolates between two planes of noise taken from distant parts of the plane.
    below = noise(x + 57.0 * (level & 63), z + 113.0 * (level & 31))
    above = noise(x + 57.0 * (level + 1 & 63), z + 113.0 * (level + 1 & 31))
    return below + (above - below) * _eased(y - level)


@kernel
def _eased(share: float) -> float:
    return share * share * (3.0 - 2.0 * share)


@kernel
def eased32(share: np.float32) -> np.float32:
    """Return a share from 0 to 1 that starts and ends level."""
    return share * share * (THREE - TWO * share)
