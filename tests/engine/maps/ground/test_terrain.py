"""Natural relief, lakes and level ground."""

from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import label

from wildscav_engine.maps.ground.lakes import DEEPEST_WATER
from wildscav_engine.maps.ground.terrain import (
    LEVEL_MARGIN,
    distance_to_footprint,
    level_ground,
    make_terrain,
    water_of_cells,
)
from wildscav_engine.maps.settlements.sites import footprints_of, settle
from wildscav_engine.specs.map_spec import MapConfig

TOO_STEEP = 1.0  # tangent of 45°


def heights_of(seed: int = 0, **config: float) -> NDArray[np.float64]:
    return make_terrain(MapConfig.model_validate(config), seed).heights


def steepness(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the steepness of the steeper triangle of each cell, as a tangent."""
    east, north = np.diff(heights, axis=1) / 2.0, np.diff(heights, axis=0) / 2.0
    return np.sqrt(np.maximum(east[:-1] ** 2 + north[:, 1:] ** 2, east[1:] ** 2 + north[:, :-1] ** 2))


def dry_cells(heights: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.isneginf(water_of_cells(heights, 0.0))


def parts(cells: NDArray[np.bool_]) -> list[NDArray[np.bool_]]:
    """Return the connected components of the true cells, the largest first."""
    labels, count = label(cells)
    return sorted((labels == number for number in range(1, count + 1)), key=lambda part: -int(part.sum()))


def connected_share(heights: NDArray[np.float64]) -> float:
    """Return the share of dry ground in the largest component that can be walked (and waded)."""
    return float(parts(steepness(heights) < TOO_STEEP)[0][dry_cells(heights)].mean())


@pytest.mark.parametrize(("size", "least", "most"), [(60, 3.0, 12.0), (100, 4.5, 18.0), (500, 12.0, 75.0)])
def test_hills_fit_the_size_of_the_map(size: int, least: float, most: float) -> None:
    for seed in range(12):
        heights = heights_of(seed, size=size, water=0.0)

        assert heights.min() == 0.0
        assert least < heights.max() < most


def test_small_maps_have_features_of_their_own_scale() -> None:
    # The residual of the best-fitting plane still varies by more than a body's height.
    for seed in range(12):
        heights = heights_of(seed, size=60, water=0.0)
        row, column = np.indices(heights.shape)
        away = np.stack([np.ones(heights.size), row.ravel(), column.ravel()], axis=1)
        plane, *_ = np.linalg.lstsq(away, heights.ravel(), rcond=None)

        rest = heights.ravel() - away @ plane
        assert rest.max() - rest.min() > 1.8


@pytest.mark.parametrize("water", [0.0, 0.2])
def test_no_relief_is_flat(water: float) -> None:
    for seed in range(4):
        heights = heights_of(seed, size=200, relief=0.0, water=water)
        dry = dry_cells(heights) if water else np.ones((100, 100), np.bool_)

        assert steepness(heights)[dry].max(initial=0.0) < 0.15
        assert heights.max() <= 0.7
        assert (heights < 0.0).mean() == pytest.approx(water, abs=0.02)


@pytest.mark.parametrize("size", [100, 300])
def test_relief_scales_heights_and_slopes(size: int) -> None:
    for seed in range(4):
        ranges = [np.ptp(heights_of(seed, size=size, water=0.0, relief=relief)) for relief in (0.5, 1, 2)]

        assert 1.3 * ranges[0] < ranges[1]
        assert 1.3 * ranges[1] < ranges[2]


def test_ruggedness_brings_cliffs_and_its_lack_plains() -> None:
    smooth = np.concatenate([steepness(heights_of(seed, size=300, ruggedness=0.0)) for seed in range(8)])
    rugged = np.concatenate([steepness(heights_of(seed, size=300, ruggedness=1.0)) for seed in range(8)])

    assert (smooth > TOO_STEEP).mean() < 0.01 < (rugged > TOO_STEEP).mean() < 0.15
    assert (smooth < 0.2).mean() > 0.5
    assert (smooth < 0.2).mean() > (rugged < 0.2).mean() + 0.05


def test_cliffs_of_rugged_land_are_higher_than_a_jump() -> None:
    # Somewhere two metres away the ground is more than 2.5 m higher.
    for seed in range(6):
        heights = heights_of(seed, size=300, ruggedness=1.0)

        assert max(np.abs(np.diff(heights, axis=axis)).max() for axis in (0, 1)) > 2.5


@pytest.mark.parametrize(
    ("config", "seeds", "least"),
    [
        ({"size": 60}, range(20), 0.85),
        ({"size": 100}, range(20), 0.85),
        ({"size": 300}, range(6), 0.85),
        # In the last four, mountains ran right across the map before the ground was connected.
        ({"size": 100, "ruggedness": 1.0, "relief": 2.0}, (*range(10), 159, 214, 278, 343), 0.65),
        ({"size": 300, "ruggedness": 1.0, "relief": 2.0}, range(6), 0.65),
    ],
)
def test_most_of_the_ground_can_be_walked_from_one_place(
    config: dict[str, float], seeds: Iterable[int], least: float
) -> None:
    for seed in seeds:
        assert connected_share(heights_of(seed, **config)) >= least, seed


@pytest.mark.parametrize("size", [60, 300])
@pytest.mark.parametrize("water", [0.03, 0.08, 0.2, 0.4])
def test_lakes_cover_the_share_asked_for_and_can_be_waded(size: int, water: float) -> None:
    for seed in range(6):
        relief = (0.2, 1.0, 2.0)[seed % 3]
        heights = heights_of(seed, size=size, water=water, relief=relief, ruggedness=0.5 * relief)

        assert (heights < 0.0).mean() == pytest.approx(water, abs=0.02), seed
        assert heights.min() >= -DEEPEST_WATER


@pytest.mark.parametrize("size", [60, 100, 300])
def test_there_are_lakes_not_puddles(size: int) -> None:
    for seed in range(8):
        lakes = parts(heights_of(seed, size=size, water=0.1) < 0.0)

        assert 1 <= len(lakes) <= 15
        assert min(int(lake.sum()) for lake in lakes) * 4.0 >= 30.0  # m²


def test_shores_slope_gently() -> None:
    for seed in range(6):
        heights = heights_of(seed, size=300, ruggedness=1.0, relief=2.0)
        wet = water_of_cells(heights, 0.0) == 0.0

        assert steepness(heights)[wet].max() < 0.5


@pytest.mark.parametrize(("size", "water"), [(40, 0.0), (62, 0.2), (1000, 0.2)])
def test_any_size_is_made_and_a_dry_one_has_no_water(size: int, water: float) -> None:
    terrain = make_terrain(MapConfig(size=size, water=water), 1)

    assert terrain.heights.shape == (size // 2 + 1, size // 2 + 1)
    assert terrain.corner == (-size / 2, -size / 2)
    assert np.isfinite(terrain.heights).all()
    assert np.all(np.isneginf(water_of_cells(terrain.heights, terrain.water_level))) == (water == 0.0)


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
    natural = np.arange(61.0)[None, :] * 0.2 + np.zeros((61, 1))
    heights = natural.copy()
    footprint = np.array([[0.0, 0.0, 0.6, 0.8, 5.0, 4.0]])

    level_ground((-60.0, -60.0), footprint, np.array([6.0]), heights)

    side = np.arange(61) * 2.0 - 60.0
    away = np.array([[distance_to_footprint(footprint[0], x, z) for x in side] for z in side]) - LEVEL_MARGIN
    assert (heights[away <= 0.0] == 6.0).all()
    assert (heights[away >= 12.0] == natural[away >= 12.0]).all()
    assert (heights >= np.minimum(6.0, natural) - 0.01).all()
    assert (heights <= np.maximum(6.0, natural) + 0.01).all()


@given(
    slope=st.floats(0.0, 0.4),
    direction=st.floats(0.0, 6.3),
    lift=st.floats(-1.5, 1.5),
    gap=st.floats(7.0, 20.0),
    levels=st.floats(-1.0, 1.0),
)
def test_joins_of_two_houses_on_a_slope_can_be_walked(
    slope: float, direction: float, lift: float, gap: float, levels: float
) -> None:
    """Joins are up to 40° steep where the ground is under 22° and the levels differ by under 0.3 m per m."""
    row, column = np.indices((71, 71)) * 2.0 - 70.0
    heights = slope * (np.cos(direction) * column + np.sin(direction) * row)
    footprints = np.array(
        [[-gap / 2 - 5.0, 0.0, 0.0, 1.0, 5.0, 6.0], [gap / 2 + 4.0, 1.0, 0.6, 0.8, 4.0, 4.0]]
    )
    apart = max(0.0, gap - 2.5 - 2.0 * LEVEL_MARGIN)  # the second is turned and reaches a bit farther

    level_ground((-70.0, -70.0), footprints, np.array([lift, lift + 0.3 * levels * apart]), heights)

    assert steepness(heights).max() < 0.84


def test_sites_are_dry() -> None:
    config = MapConfig(size=100, houses=5, water=0.4)
    terrain = make_terrain(config, 0)
    sites = settle(config, 0, terrain, [(10.0, 8.0)] * 5).sites

    for footprint in footprints_of(sites):
        for row, column in zip(*np.nonzero(terrain.heights < 0.0), strict=True):
            assert distance_to_footprint(footprint, 2.0 * column - 50.0, 2.0 * row - 50.0) > LEVEL_MARGIN
