"""Terraces: wards at different levels, with steps between them too steep to climb, and few ramps."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps.country.ridges import points_of
from wildscav_engine.maps.country.wards import Barrier, Border, Wards
from wildscav_engine.maps.ground.terrain import Terrain

RAMP_SLOPE = 0.5  # m up per m, in addition to that of the ground
RAMP_REACH = 3.4  # m on either side of a ramp's axis


def ward_of_points(wards: Wards, terrain: Terrain) -> NDArray[np.int64]:
    """Return (R + 1, C + 1) the ward that each point of the height field is in."""
    x, z = points_of(terrain)
    found = np.zeros(terrain.heights.shape, np.int64)
    count = len(wards.numbers)
    for row in range(count):
        for column in range(count):
            quadrangle = wards.corners[[row, row, row + 1, row + 1], [column, column + 1, column + 1, column]]
            inside = np.ones(found.shape, np.bool_)
            for start, end in zip(quadrangle, np.roll(quadrangle, -1, axis=0), strict=True):
                east, north = end - start
                inside &= east * (z - start[1]) - north * (x - start[0]) >= 0.0
            found[inside] = wards.numbers[row, column]
    return found


def raise_terraces(wards: Wards, terrain: Terrain) -> None:
    """Raise the ground of each ward, in place, to its level, and lay the ramps."""
    if not wards.levels.any():
        return
    natural = terrain.heights.copy()
    terrain.heights[:] = natural + wards.levels[ward_of_points(wards, terrain)]
    for border in wards.borders:
        if border.barrier is Barrier.CLIFF and border.gate is not None:
            _lay_ramp(wards, border, border.gate, natural, terrain)


def _lay_ramp(
    wards: Wards, border: Border, gate: float, natural: NDArray[np.float64], terrain: Terrain
) -> None:
    """Lay the ramp across a border, in place."""
    x, z = points_of(terrain)
    middle, (east, north) = border.at(gate), border.direction
    left, right = (float(wards.levels[number]) for number in border.wards)
    across = (x - middle[0]) * east + (z - middle[1]) * north
    to_right = (x - middle[0]) * north - (z - middle[1]) * east
    length = abs(right - left) / RAMP_SLOPE
    on_ramp = (np.abs(across) <= RAMP_REACH) & (np.abs(to_right) <= length / 2.0)
    height = natural + left + (right - left) * (to_right / length + 0.5)
    np.copyto(terrain.heights, height, where=on_ramp)
