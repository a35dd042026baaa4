"""Villages on steep ground: no house is buried or hangs in the air, and every room can be entered."""

import numpy as np
import pytest
from tests.engine.maps.by_hand import footprint_of, lost_rooms

from wildscav_engine.maps import GameMap, MapError, generate_map
from wildscav_engine.maps.ground.terrain import (
    LEVEL_MARGIN,
    LONGEST_JOIN,
    Terrain,
    level_ground,
    room_of_join,
)
from wildscav_engine.maps.house import FLOOR_LIFT
from wildscav_engine.maps.layout import lay_out
from wildscav_engine.maps.locations import houses_cut_off
from wildscav_engine.maps.placements import fixed_houses
from wildscav_engine.maps.settlements.footprints import gap_between, heights_under
from wildscav_engine.maps.settlements.plots import level_for
from wildscav_engine.specs.map_spec import MapConfig, Placement

CROWDED = MapConfig(
    size=256, houses=29, relief=2, ruggedness=1, water=0, storeys=(1, 3), vegetation=0.4
)  # a house for every 2,200 m²


def check_houses(game_map: GameMap) -> None:
    world = game_map.world
    terrain = Terrain((world.corner[0], world.corner[1]), world.heights, -np.inf)
    for number, house in enumerate(game_map.houses):
        lowest, highest, _ = heights_under(terrain, footprint_of(house))
        level = house.ground - FLOOR_LIFT
        assert (lowest, highest) == pytest.approx((level, level), abs=1e-9), f"house {number}"
    assert lost_rooms(game_map) == []


def test_the_village_whose_houses_were_buried_stands_on_its_ground() -> None:
    check_houses(generate_map(CROWDED, 403674277200025))


@pytest.mark.slow
def test_a_house_that_would_be_cut_off_by_cliffs_stands_elsewhere() -> None:
    first = lay_out(CROWDED, 68)
    game_map = generate_map(CROWDED, 68)
    assert [house.center for house in game_map.houses] != [house.center for house in first.houses]
    check_houses(game_map)


def test_a_house_is_cut_off_if_nobody_gets_into_one_of_its_rooms() -> None:
    game_map = generate_map(MapConfig(size=60, houses=2, storeys=(2, 2), relief=0.0, water=0.0), 1)
    assert houses_cut_off(game_map.houses, game_map.indoor) == []
    house = game_map.houses[1]
    across, along = house.pose.inside(game_map.indoor[:, 0], game_map.indoor[:, 2])
    for level in range(2):  # places on the other storey do not count
        area = next(room.area for room in house.rooms if room.level == level)
        off_floor = np.abs(game_map.indoor[:, 1] - house.ground - level * house.storey_height)
        inside = area.holds(across, along) & (off_floor < 0.2)
        assert houses_cut_off(game_map.houses, game_map.indoor[~inside]) == [1]
    assert houses_cut_off(game_map.houses, game_map.indoor[:0]) == [0, 1]


@pytest.mark.parametrize("density", ["low", "high"])
@pytest.mark.parametrize("seed", range(4))
def test_every_room_of_a_small_steep_village_is_reached(density: str, seed: int) -> None:
    config = CROWDED.model_copy(update={"size": 120, "houses": 6, "density": density})
    check_houses(generate_map(config, seed))


@pytest.mark.parametrize(("gap", "fits"), [(20.0, 4.1), (40.0, 20.9), (87.0, 100.0)])
def test_two_houses_keep_levels_that_the_ground_between_them_can_join(gap: float, fits: float) -> None:
    """A house on the other side of a cliff gets a level if the cliff is low enough for the gap."""
    size = (8.0, 8.0)
    one = np.array((-40.0, 0.0, 0.0, 1.0, size[0] / 2, size[1] / 2))
    other = one + np.array((gap + size[0], 0, 0, 0, 0, 0))
    assert gap_between(one, other) == gap
    side = np.arange(121) * 2.0 - 120.0
    for rise, expected in ((fits, True), (fits * 1.1, gap - 2 * LEVEL_MARGIN >= LONGEST_JOIN)):
        heights = np.tile(np.where(side < -40.0 + 0.5 * (gap + size[0]), 0.0, rise), (len(side), 1))
        terrain = Terrain((-120.0, -120.0), heights, -np.inf)
        level = level_for(terrain, other, one[None], np.zeros(1))
        assert (level > -np.inf) == expected
        if expected:
            level_ground(terrain.corner, np.array([one, other]), np.array([0.0, level]), heights)
            for house, ground in ((one, 0.0), (other, rise)):
                assert heights_under(terrain, house)[:2] == pytest.approx((ground, ground))


def test_the_room_of_a_join_grows_with_the_distance_and_has_no_limit_far_away() -> None:
    rooms = [room_of_join(away) for away in np.linspace(0.0, LONGEST_JOIN, 50)]
    assert rooms[0] == 0.0
    assert rooms == sorted(rooms)
    assert rooms[-1] == np.inf


def test_a_house_by_hand_between_two_that_are_too_far_apart_in_height_is_refused() -> None:
    """The ground rises by 7 m at x = 9. All three houses are so close that they have to share a level."""
    side = np.arange(61) * 2.0 - 60.0
    terrain = Terrain((-60.0, -60.0), np.tile(np.where(side < 9.0, 0.0, 7.0), (61, 1)), -np.inf)
    houses = [Placement(kind="house", location=(x, 0.0), area=(8.0, 8.0)) for x in (-12.0, 16.0, 2.0)]
    _, apart = fixed_houses(MapConfig(size=120, houses=0, placements=tuple(houses[:2])), 1, terrain)
    assert [site.ground for site in apart] == [0.0, 7.0]
    with pytest.raises(MapError, match=r"placements.2.location is .* at 7.0 m or more .* at 0.0 m or less"):
        fixed_houses(MapConfig(size=120, houses=0, placements=tuple(houses)), 1, terrain)
