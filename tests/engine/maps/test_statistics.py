"""The guarantees of maps, checked on dozens of random ones; and that no two are alike."""

from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.maps.by_hand import footprint_of, lost_rooms

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.layout import NO_HOUSE
from wildscav_engine.maps.settlements.footprints import farthest_out, gap_between
from wildscav_engine.maps.settlements.sites import CLOSE_GAP, EDGE_MARGIN
from wildscav_engine.specs.map_spec import MapConfig

BATCH = 20  # maps per test
PLANTS = (Kind.TRUNK, Kind.CROWN, Kind.BUSH, Kind.ROCK)


def small_config(seed: int) -> MapConfig:
    """Return the config of a map of 60 to 120 m of any kind, with as many houses as certainly fit."""
    dice = RandomStream(seed, Stream.SUITE, agent=1)
    size = 2 * dice.integer(30, 60)
    return MapConfig(
        size=size,
        houses=dice.integer(0, size // 30),
        storeys=((1, 1), (1, 2), (2, 3), (1, 4), (4, 4))[dice.integer(0, 4)],
        density=("low", "high")[seed % 2],
        relief=dice.uniform(0.0, 1.2),
        ruggedness=dice.uniform(),
        water=dice.uniform(0.0, 0.25),
        vegetation=dice.uniform(),
    )


def great_config(seed: int) -> MapConfig:
    """Return the config of a map of 500 m, as in competitions."""
    dice = RandomStream(seed, Stream.SUITE, agent=2)
    return MapConfig(
        size=500,
        houses=dice.integer(8, 20),
        storeys=((1, 3), (2, 3))[dice.integer(0, 1)],
        density=("low", "high")[seed % 2],
        ruggedness=dice.uniform(),
        water=dice.uniform(0.0, 0.2),
    )


@pytest.mark.parametrize("batch", range(2))
def test_small_maps_keep_their_promises(batch: int) -> None:
    for seed in range(batch * BATCH, (batch + 1) * BATCH):
        check_promises(generate_map(small_config(seed), seed))


@pytest.mark.slow
def test_great_maps_keep_their_promises() -> None:
    for seed in range(4):
        check_promises(generate_map(great_config(seed), seed))


def check_promises(game_map: GameMap) -> None:
    check_houses(game_map)
    check_water(game_map)
    check_places(game_map)
    check_plants(game_map)


def check_houses(game_map: GameMap) -> None:
    """Check the number of houses and storeys, their distances, and that every room can be entered."""
    config = game_map.config
    assert len(game_map.houses) == config.houses, config
    assert all(config.storeys[0] <= house.storeys <= config.storeys[1] for house in game_map.houses)
    footprints = [footprint_of(house) for house in game_map.houses]
    assert all(gap_between(one, other) >= CLOSE_GAP for one, other in combinations(footprints, 2))
    assert all(farthest_out(one) <= config.size / 2 - EDGE_MARGIN for one in footprints)
    assert lost_rooms(game_map) == [], config


def check_water(game_map: GameMap) -> None:
    """Check that about the wanted share of the map is under lakes, and that lakes can be waded."""
    world, asked = game_map.world, game_map.config.water
    nodes = world.heights[1:-1, 1:-1]
    level = world.water.max()
    share = (nodes < level).mean() if level > -np.inf else 0.0
    assert share == pytest.approx(asked, abs=0.06), game_map.config
    if share:
        assert level - world.heights.min() <= 1.21


def check_places(game_map: GameMap) -> None:
    """Check that there are enough places outdoors and indoors, and no spawn in water or on a roof."""
    config, world = game_map.config, game_map.world
    assert game_map.reachable_share > 0.6, config
    squares = (config.size / 4) ** 2
    assert 0.3 * squares < len(game_map.outdoor) < 1.1 * squares
    rooms = sum(len(house.rooms) for house in game_map.houses)
    assert rooms <= len(game_map.indoor) <= 12 * rooms
    for x, y, z in world.spawns:
        assert water_at(world, x, z) == -np.inf
        assert y == pytest.approx(ground_at(world, x, z).height, abs=0.01)


def check_plants(game_map: GameMap) -> None:
    """Check that no plant or rock is part of a house, and that there is none without vegetation."""
    world = game_map.world
    plants = np.nonzero(np.isin(world.solid_kind, PLANTS))[0]
    assert (game_map.solid_house[plants] == NO_HOUSE).all()
    if game_map.config.vegetation == 0.0:
        assert len(plants) == 0


def test_two_seeds_differ_in_structure_and_not_only_in_noise() -> None:
    config = MapConfig(size=200, houses=6, storeys=(1, 3))
    maps = [generate_map(config, seed) for seed in range(6)]
    likeness = []
    for one, other in combinations(maps, 2):
        # Relief: heights averaged over squares of 25 m.
        likeness.append(abs(np.corrcoef(lie_of(one).ravel(), lie_of(other).ravel())[0, 1]))
        # Houses are different and at different places.
        apart = [
            min(np.hypot(*np.subtract(house.center, twin.center)) for twin in other.houses)
            for house in one.houses
        ]
        assert np.mean(apart) > 5.0
        assert {house.size for house in one.houses}.isdisjoint({house.size for house in other.houses})
        assert [len(house.rooms) for house in one.houses] != [len(house.rooms) for house in other.houses]
    assert np.mean(likeness) < 0.5
    assert max(likeness) < 0.95


def lie_of(game_map: GameMap) -> NDArray[np.float64]:
    heights = game_map.world.heights[:96, :96]
    return heights.reshape(8, 12, 8, 12).mean(axis=(1, 3))
