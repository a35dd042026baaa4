"""Shaping the ground of a country along its borders: canyons and terraces.

Canyons are ridges of rock, too steep to climb, with passes. Terraces are wards at different levels, with
steps between them too steep to climb, and few ramps.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.country.wards import Barrier, Border, Wards
from wildscav_engine.maps.ground.terrain import Terrain

REACH = 2.3  # m on either side of a border; at least two points of the height field across
PASS = 4.3  # m around the middle of a pass that stay as they are
RISE, MORE = 5.0, 3.0  # m: the least rise, and how much more there may be
RAMP_SLOPE = 0.5  # m up per m, in addition to that of the ground
RAMP_REACH = 3.4  # m on either side of a ramp's axis


def raise_ridges(wards: Wards, seed: int, terrain: Terrain) -> None:
    """Raise the ground, in place, along the borders that are ridges."""
    x, z = points_of(terrain)
    rise = np.zeros(terrain.heights.shape)
    for number, border in enumerate(wards.borders):
        if border.barrier is not Barrier.RIDGE:
            continue
        dice = RandomStream(seed, Stream.COUNTRY, agent=10_000 + number)
        height = RISE + dice.uniform(0.0, MORE)
        lower = dice.uniform(0.0, 0.25)
        east, north = border.direction
        along = (x - border.start[0]) * east + (z - border.start[1]) * north
        aside = (x - border.start[0]) * north - (z - border.start[1]) * east
        beyond = along - np.clip(along, 0.0, border.length)
        raised = aside * aside + beyond * beyond <= REACH * REACH
        if border.gate is not None:
            from_gate = along - border.gate
            raised &= from_gate * from_gate + aside * aside > PASS * PASS
        # Jagged: every second point along it is a little lower.
        jags = height * (1.0 - lower * (np.floor(along / CELL) % 2.0))
        np.copyto(rise, np.maximum(rise, np.maximum(jags, RISE)), where=raised)
    np.add(terrain.heights, rise, out=terrain.heights)


def points_of(terrain: Terrain) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x (1, C + 1) and z (R + 1, 1) in m of the points of the height field."""
    rows, columns = terrain.heights.shape
    x = terrain.corner[0] + CELL * np.arange(columns, dtype=np.float64)[None, :]
    z = terrain.corner[1] + CELL * np.arange(rows, dtype=np.float64)[:, None]
    return x, z


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


def wards_at(
    wards: Wards, terrain: Terrain, x: NDArray[np.float64], z: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return (N,) the wards of places in m: those of the nearest points of the height field."""
    columns = ((x - terrain.corner[0]) / CELL + 0.5).astype(np.int64)
    rows = ((z - terrain.corner[1]) / CELL + 0.5).astype(np.int64)
    return ward_of_points(wards, terrain)[rows, columns]


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
