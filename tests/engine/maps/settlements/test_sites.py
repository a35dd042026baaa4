"""Sites of houses: in towns along streets or on farmsteads, never overlapping, in water or on lanes."""

from functools import partial

import numpy as np
import pytest
from tests.engine.maps.by_hand import level_ground

from wildscav_engine.geometry.segments import nearest_on
from wildscav_engine.maps.ground.terrain import distance_to_footprint, make_terrain
from wildscav_engine.maps.house import draw_plan
from wildscav_engine.maps.settlements.sites import (
    CLOSE_GAP,
    Settlement,
    Site,
    door_paths,
    footprints_of,
    gap_between,
    room_for,
    settle,
)
from wildscav_engine.specs.map_spec import MapConfig, Placement

Sizes = list[tuple[float, float]]


def sizes_of(houses: int, seed: int = 0, *, small: bool = False) -> Sizes:
    return [draw_plan(seed, number, (1, 2), small=small).size for number in range(houses)]


def settled(seed: int = 0, **config: object) -> Settlement:
    """Return houses on generated ground."""
    chosen = MapConfig.model_validate(config)
    return settle(chosen, seed, make_terrain(chosen, seed), sizes_of(chosen.houses, seed))


def distance_to_lanes(lanes: np.ndarray, x: float, z: float) -> float:
    nearest = [nearest_on(lane, x, z) for lane in lanes]
    return min(np.hypot(x - to_x, z - to_z) for to_x, to_z in nearest)


def distance_to_nearest(sites: list[Site]) -> float:
    """Return the mean distance in m from a house to the nearest other."""
    middles = np.array([(site.pose.x, site.pose.z) for site in sites])
    apart = np.hypot(*(middles[:, None] - middles[None]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return float(apart.min(axis=1).mean())


@pytest.mark.parametrize("seed", [0, 1])
def test_houses_stand_closer_where_density_is_high(seed: int) -> None:
    high, low = (settled(seed, size=500, houses=15, density=density).sites for density in ("high", "low"))

    assert len(high) == len(low) == 15
    assert distance_to_nearest(high) < 25.0
    assert distance_to_nearest(low) > 2.0 * distance_to_nearest(high)


@pytest.mark.parametrize("houses", [3, 12, 60])
def test_houses_of_a_town_face_its_streets(houses: int) -> None:
    config = MapConfig(size=500, houses=houses, density="high")
    sites, lanes = settle(config, 3, level_ground(500), sizes_of(houses))

    assert len(sites) == houses
    for site in sites:
        front, back = (
            distance_to_lanes(lanes, *site.pose.outside(0.0, end * site.size[1] / 2)) for end in (1, -1)
        )
        assert front < 7.0
        assert front < back


@pytest.mark.parametrize("seed", range(2))
def test_no_house_stands_on_a_lane(seed: int) -> None:
    sites, lanes = settled(seed, size=500, houses=40, density="high")
    points = np.concatenate([lanes[:, :2], lanes[:, 2:], (lanes[:, :2] + lanes[:, 2:]) / 2])

    for footprint in footprints_of(sites):
        assert min(distance_to_footprint(footprint, x, z) for x, z in points) > 2.0


def test_many_houses_make_several_towns() -> None:
    sites = settled(1, size=1000, houses=80, density="high").sites
    middles = np.array([(site.pose.x, site.pose.z) for site in sites])
    towns = 0
    left = set(range(len(sites)))
    while left:
        towns += 1
        town = [left.pop()]
        for one in town:
            near = {other for other in left if np.hypot(*(middles[one] - middles[other])) < 60}
            left -= near
            town += near

    assert 2 <= towns <= 15


def test_farmsteads_have_no_lanes() -> None:
    assert settled(0, size=300, houses=5, density="low").lanes.shape == (0, 4)


@pytest.mark.parametrize("density", ["low", "high"])
def test_no_house_stands_where_the_ground_is_steep_or_under_water(density: str) -> None:
    config = MapConfig.model_validate({"size": 200, "houses": 5, "density": density})

    assert settle(config, 0, level_ground(200, slope=0.6), sizes_of(5)).sites == []
    assert settle(config, 0, level_ground(200, water_level=0.5), sizes_of(5)).sites == []
    half_wet = settle(config, 0, level_ground(200, slope=0.1, water_level=0.0), sizes_of(5)).sites
    assert len(half_wet) == 5
    assert all(site.pose.x > 0 for site in half_wet)


@pytest.mark.parametrize("density", ["low", "high"])
@pytest.mark.parametrize("seed", range(3))
def test_as_many_houses_have_room_as_it_is_said(density: str, seed: int) -> None:
    config = MapConfig.model_validate({"size": 80, "houses": 60, "density": density})
    terrain = make_terrain(config, seed)
    sizes = sizes_of(60, seed, small=True)
    room = room_for(partial(settle, config, seed, terrain), sizes)

    assert 0 < room < 60
    assert len(settle(config, seed, terrain, sizes[:room]).sites) == room


@pytest.mark.parametrize("density", ["low", "high"])
def test_houses_keep_clear_of_what_is_placed_by_hand(density: str) -> None:
    block = Placement(kind="block", location=(-20.0, 0.0), area=(40.0, 4.0), orientation=30.0)
    config = MapConfig.model_validate({"size": 120, "houses": 8, "density": density, "placements": (block,)})
    fixed = [Site(*old) for old in settle(MapConfig(size=120), 9, level_ground(120), [(12.0, 9.0)]).sites]
    sites = settle(config, 0, level_ground(120), sizes_of(8), fixed).sites
    wall = footprints_of(
        [Site(fixed[0].pose._replace(x=-20.0, z=0.0, sine=0.5, cosine=0.75**0.5), 30, (40, 4), 0)]
    )

    assert len(sites) == 8
    for footprint in footprints_of(sites):
        assert gap_between(footprint, footprints_of(fixed)[0]) >= CLOSE_GAP
        assert gap_between(footprint, wall[0]) >= 3.0


def test_footprints_that_cross_overlap_though_no_corner_is_in_the_other() -> None:
    one, other = np.array([0.0, 0, 0, 1, 10, 1]), np.array([6.0, 0, 0, 1, 1, 10])

    assert gap_between(one, other) == 0.0
    assert gap_between(one, np.array([14.0, 0, 0, 1, 1, 10])) == pytest.approx(3.0)
    assert gap_between(one, np.array([14.0, 5, 0, 1, 1, 1])) == pytest.approx(np.hypot(3, 3))


def test_paths_lead_from_doors_to_the_lane_they_are_near() -> None:
    lanes = np.array([[0.0, -20, 0, 20], [0, 20, 30, 20]])
    paths = door_paths(lanes, np.array([[6.0, 3.0], [-40.0, 0.0], [12.0, 24.0]]))

    assert paths == pytest.approx(np.array([[6, 3, 0, 3], [12, 24, 12, 20]]))
