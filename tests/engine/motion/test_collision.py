"""The solids near a body: marked once, swept often, with the same result as sweeping all."""

import numpy as np
import pytest
from tests.builders import box, flat_world

from wildscav_engine.geometry.sweep import sweep_world
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.collision import BITS, find_nearby_solids, has_nearby_solids, sweep_nearby_solids

REACH = 0.9  # m, less than half a cell of 2 m
# Solids in one cell, from (0, 0) to (2, 2): its south-west corner is at row 10, column 10 of the map.
CELL = [
    box((0.2, 0.0, 0.2), (0.4, 0.3, 0.4)),
    box((1.6, 0.5, 1.6), (1.8, 2.0, 1.8)),
    box((0.2, 4.0, 0.2), (0.4, 5.0, 0.4)),
]


def marked(x: float, z: float, low: float = 0.0, high: float = 3.0) -> list[int]:
    near = find_nearby_solids(flat_world(40, CELL), x, z, REACH, low, high)
    assert not near.is_crowded
    return [near.south_west, near.south_east, near.north_west, near.north_east]


@pytest.mark.parametrize(
    ("place", "bits"),
    [
        ((0.95, 0.95), [0b11, 0, 0, 0]),  # both are within reach and within height
        ((0.9, 0.6), [0, 0, 0b01, 0]),  # 1.6 - 0.6 is more than 0.9; now the cell is the northern one of two
        ((1.05, 1.4), [0b10, 0, 0, 0]),
        ((-0.5, 0.9), [0, 0b01, 0, 0]),  # their cell is the eastern one of two
        ((0.9, -0.5), [0, 0, 0b01, 0]),
        ((-0.5, -0.5), [0, 0, 0, 0b01]),
        ((5.0, 5.0), [0, 0, 0, 0]),
    ],
)
def test_bits_stand_for_the_solids_of_four_cells(place: tuple[float, float], bits: list[int]) -> None:
    assert marked(*place) == bits


@pytest.mark.parametrize(
    ("low", "high", "bits"), [(0.0, 0.4, 0b001), (0.4, 3.0, 0b010), (0.0, 4.0, 0b111), (5.1, 9.0, 0)]
)
def test_what_is_too_high_or_too_low_is_not_marked(low: float, high: float, bits: int) -> None:
    assert marked(0.95, 0.95, low, high)[0] == bits


def test_a_solid_in_several_cells_is_marked_once() -> None:
    near = find_nearby_solids(flat_world(40, [box((-3, 0, -3), (3, 1, 3))]), 0.0, 0.0, REACH, 0.0, 2.0)

    assert [near.south_west, near.south_east, near.north_west, near.north_east] == [1, 0, 0, 0]
    assert has_nearby_solids(near)
    assert not has_nearby_solids(near._replace(south_west=0))


def heaps(count: int, spread: float) -> World:
    """A map with so many small boxes about its middle."""
    dice = np.random.default_rng(count)
    places = dice.uniform((-spread, 0, -spread), (spread, 2.5, spread), (count, 3))
    sizes = dice.uniform(0.05, 0.5, (count, 3))
    return flat_world(40, [box(p, p + s) for p, s in zip(places, sizes, strict=True)])


@pytest.mark.parametrize(
    ("count", "spread", "is_crowded"),
    [(40, 3.0, False), (BITS, 0.7, False), (400, 2.0, True)],  # more than 62 solids in a cell have no bits
)
def test_sweeping_what_is_near_is_sweeping_all(count: int, spread: float, is_crowded: bool) -> None:
    world = heaps(count, spread)
    dice = np.random.default_rng(2)
    touched = crowded = 0
    for x, y, z, dx, dy, dz in dice.uniform(
        (-3, 0, -3, -0.4, -0.4, -0.4), (3, 2, 3, 0.4, 0.4, 0.4), (300, 6)
    ):
        near = find_nearby_solids(world, x, z, REACH, y - 0.5, y + 2.5)
        contact = sweep_nearby_solids(world, near, x, y, z, dx, dy, dz)
        assert contact == sweep_world(world, x, y, z, dx, dy, dz)
        touched += contact.fraction < 1.0
        crowded += near.is_crowded
    assert touched > 10
    assert (crowded > 0) is is_crowded
