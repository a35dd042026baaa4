"""Canyons: ridges of rock along borders, too steep to climb, with passes."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.country.wards import Barrier, Wards
from wildscav_engine.maps.ground.terrain import Terrain

REACH = 2.3  # m on either side of a border; at least two points of the height field across
PASS = 4.3  # m around the middle of a pass that stay as they are
RISE, MORE = 5.0, 3.0  # m: the least rise, and how much more there may be


def raise_ridges(wards: Wards, seed: int, terrain: Terrain) -> None:
    """Raise the ground, in place, along the borders that are ridges."""
    x, z = points_of(terrain)
    rise = np.zeros(terrain.heights.shape)
    for number, border in enumerate(wards.borders):
        if border.barrier is not Barrier.RIDGE:
            continue
        dice = Dice(seed, Stream.COUNTRY, agent=10_000 + number)
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
