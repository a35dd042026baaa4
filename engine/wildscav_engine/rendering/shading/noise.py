"""Deterministic noise for the grain of surfaces in pictures."""

import math

from wildscav_engine.compilation.kernel import kernel

LOW_32 = 0xFFFFFFFF


@kernel
def grain(x: int, y: int, z: int) -> float:
    """Return a pseudo-random number in [0, 1) for a point of the integer lattice."""
    mixed = x * 374761393 + y * 668265263 + z * 974634533 & LOW_32
    mixed = (mixed ^ mixed >> 13) * 1274126177 & LOW_32
    return (mixed ^ mixed >> 16) / 4294967296.0


@kernel
def noise(x: float, z: float) -> float:
    """Return smooth noise in [0, 1) over a plane, with features of length 1."""
    column, row = math.floor(x), math.floor(z)
    east, north = _eased(x - column), _eased(z - row)
    south = grain(column, row, 0) + (grain(column + 1, row, 0) - grain(column, row, 0)) * east
    top = grain(column, row + 1, 0) + (grain(column + 1, row + 1, 0) - grain(column, row + 1, 0)) * east
    return south + (top - south) * north


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
