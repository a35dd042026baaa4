"""Hills, lakes and level ground."""

import numpy as np
import pytest

from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.sites import footprints_of, place_houses
from wildscav_engine.maps.terrain import (
    DEEPEST_WATER,
    LEVEL_MARGIN,
    distance_to_footprint,
    level_ground,
    make_terrain,
    water_of_cells,
)
from wildscav_engine.spec import MapConfig


def wet_share(game_map: GameMap) -> float:
    return float((game_map.world.heights < 0.0).mean())


@pytest.mark.parametrize(("size", "least", "most"), [(60, 2.0, 4.5), (100, 3.5, 7.0), (500, 18.0, 34.0)])
def test_hills_fit_the_size_of_the_map(size: int, least: float, most: float) -> None:
    for seed in range(4):
        heights = make_terrain(MapConfig(size=size, water=0.0), seed).heights

        assert least < heights.max() - heights.min() < most


@pytest.mark.parametrize("water", [0.05, 0.2, 0.4])
@pytest.mark.parametrize("seed", [0, 1])
def test_lakes_cover_about_the_share_asked_for_and_can_be_waded(water: float, seed: int) -> None:
    game_map = generate_map(MapConfig(size=100, houses=2, water=water), seed)

    assert wet_share(game_map) == pytest.approx(water, abs=0.02)
    assert game_map.world.heights.min() >= -DEEPEST_WATER


def test_a_dry_map_has_no_water() -> None:
    assert np.all(np.isneginf(generate_map(MapConfig(size=60, houses=1, water=0.0), 0).world.water))


def test_water_stands_over_every_cell_with_ground_below_it() -> None:
    heights = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, -0.1]])

    assert water_of_cells(heights, 0.0).tolist() == [[-np.inf, 0.0]]


def test_distance_to_a_turned_footprint() -> None:
    # Half sizes 2 and 1, looking east: 1 m to the east and west, 2 m to the north and south.
    footprint = np.array([10.0, 0.0, 1.0, 0.0, 2.0, 1.0])

    assert distance_to_footprint(footprint, 10.5, 1.9) == 0.0
    assert distance_to_footprint(footprint, 14.0, 0.0) == 3.0
    assert distance_to_footprint(footprint, 14.0, 6.0) == 5.0


def test_the_ground_is_level_around_a_house_and_natural_far_away() -> None:
    natural = np.arange(41.0)[None, :] * 0.2 + np.zeros((41, 1))
    heights = natural.copy()
    footprint = np.array([[0.0, 0.0, 0.6, 0.8, 5.0, 4.0]])

    level_ground((-40.0, -40.0), footprint, np.array([3.5]), heights)

    for row in range(41):
        for column in range(41):
            away = distance_to_footprint(footprint[0], -40.0 + 2.0 * column, -40.0 + 2.0 * row)
            if away <= LEVEL_MARGIN:
                assert heights[row, column] == 3.5
            elif away >= LEVEL_MARGIN + 8.0:
                assert heights[row, column] == natural[row, column]
            else:
                low, high = sorted((3.5, natural[row, column]))
                assert low <= heights[row, column] <= high


@pytest.mark.parametrize("density", ["low", "high"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_slopes_can_be_walked(density: str, seed: int) -> None:
    heights = generate_map(MapConfig(size=100, houses=8, density=density), seed).world.heights
    east, north = np.diff(heights, axis=1) / 2.0, np.diff(heights, axis=0) / 2.0

    assert np.sqrt(east[:-1] ** 2 + north[:, 1:] ** 2).max() < 1.0
    assert np.sqrt(east[1:] ** 2 + north[:, :-1] ** 2).max() < 1.0


def test_sites_are_dry() -> None:
    config = MapConfig(size=100, houses=5, water=0.4)
    terrain = make_terrain(config, 0)
    sites = place_houses(config, 0, terrain, [(10.0, 8.0)] * 5)

    for footprint in footprints_of(sites):
        for row, column in zip(*np.nonzero(terrain.heights < 0.0), strict=True):
            assert distance_to_footprint(footprint, 2.0 * column - 50.0, 2.0 * row - 50.0) > LEVEL_MARGIN
