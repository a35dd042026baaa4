"""Houses: where they stand, and that their openings and stairs are open."""

from itertools import pairwise

import numpy as np
import pytest

from wildscav_engine.body import BODY_HEIGHT
from wildscav_engine.geometry.rays import cast_ray
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.generate import NO_HOUSE, plans_and_sites
from wildscav_engine.maps.house_plan import (
    DOOR_HEIGHT,
    DOOR_WIDTH,
    GOING,
    LANDING,
    RISE,
    STEPS,
    STOREY_HEIGHT,
    HousePlan,
    Opening,
    Rectangle,
    Wall,
    draw_plan,
)
from wildscav_engine.maps.houses import FLOOR_LIFT, around_hole
from wildscav_engine.maps.locations import is_clear
from wildscav_engine.maps.sites import CLOSE_GAP, EDGE_MARGIN, Site, corner_of, footprints_of, gap_between
from wildscav_engine.spec import MapConfig

CONFIG = MapConfig(size=80, houses=4, storeys=(2, 3), vegetation=0.0)
SEEDS = [0, 1]
HEAD_ROOM = 2.2  # m


def houses_of(seed: int) -> tuple[GameMap, list[tuple[HousePlan, Site]]]:
    return generate_map(CONFIG, seed), list(zip(*plans_and_sites(CONFIG, seed), strict=True))


def middle_of(wall: Wall, opening: Opening) -> tuple[float, float]:
    outline = wall.outline
    if wall.is_across:
        return opening.middle, (outline.back + outline.front) / 2.0
    return (outline.left + outline.right) / 2.0, opening.middle


def is_open(game_map: GameMap, site: Site, wall: Wall, place: tuple[float, float], height: float) -> bool:
    """Cast a ray of 0.6 m straight through a wall."""
    aside = (0.0, -0.3) if wall.is_across else (-0.3, 0.0)
    x, z = site.pose.outside(place[0] + aside[0], place[1] + aside[1])
    end_x, end_z = site.pose.outside(place[0] - aside[0], place[1] - aside[1])
    way_x, way_z = (end_x - x) / 0.6, (end_z - z) / 0.6
    return bool(np.isinf(cast_ray(game_map.world, x, height, z, way_x, 0.0, way_z, 0.6).distance))


@pytest.mark.parametrize("seed", SEEDS)
def test_there_are_as_many_houses_and_storeys_as_configured(seed: int) -> None:
    game_map = generate_map(CONFIG, seed)

    assert len(game_map.houses) == 4
    for house in game_map.houses:
        assert 2 <= house.storeys <= 3
        assert house.storey_height == 3.0
        assert 8.0 <= house.size[0] <= 14.0
        assert 7.0 <= house.size[1] <= 12.0


def test_storeys_cover_their_whole_range() -> None:
    assert {len(draw_plan(seed, 0, (1, 4)).storeys) for seed in range(40)} == {1, 2, 3, 4}


@pytest.mark.parametrize("density", ["low", "high"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_houses_keep_apart_and_off_the_edge(density: str, seed: int) -> None:
    config = MapConfig(size=100, houses=8, density=density)
    footprints = footprints_of(plans_and_sites(config, seed)[1])

    for number, footprint in enumerate(footprints):
        for corner in range(4):
            assert np.abs(corner_of(footprint, corner)).max() <= 50.0 - EDGE_MARGIN
        for other in footprints[:number]:
            assert gap_between(footprint, other) >= CLOSE_GAP


@pytest.mark.parametrize("seed", [0, 1])
def test_high_density_puts_houses_nearer_together_than_low(seed: int) -> None:
    spread = []
    for density in ("high", "low"):
        config = MapConfig(size=300, houses=10, density=density)
        centers = np.array([house.center for house in generate_map(config, seed).houses])
        spread.append(np.abs(centers - centers.mean(axis=0)).mean())

    assert spread[0] < 0.5 * spread[1]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_house_stands_just_above_level_ground(seed: int) -> None:
    game_map, houses = houses_of(seed)

    for house, (plan, site) in zip(game_map.houses, houses, strict=True):
        for across in (-0.5, 0.0, 0.5):
            for along in (-0.5, 0.0, 0.5):
                x, z = site.pose.outside(across * plan.size[0], along * plan.size[1])
                assert 0.0 < house.ground - ground_at(game_map.world, x, z).height <= 0.1


@pytest.mark.parametrize("seed", SEEDS)
def test_solids_know_their_house(seed: int) -> None:
    game_map, _ = houses_of(seed)
    world = game_map.world
    middles = (world.solid_low + world.solid_high) / 2.0

    for number, house in enumerate(game_map.houses):
        mine = middles[game_map.solid_house == number]
        assert len(mine) > 50
        reach = np.hypot(house.size[0], house.size[1]) / 2.0
        assert np.hypot(mine[:, 0] - house.center[0], mine[:, 2] - house.center[1]).max() <= reach
    built = np.isin(world.solid_kind, [Kind.TRUNK, Kind.CROWN, Kind.ROCK], invert=True)
    assert np.array_equal(built, game_map.solid_house != NO_HOUSE)


@pytest.mark.parametrize("seed", SEEDS)
def test_bodies_pass_every_doorway(seed: int) -> None:
    game_map, houses = houses_of(seed)

    for plan, site in houses:
        for level, storey in enumerate(plan.storeys):
            floor = site.ground + FLOOR_LIFT + level * STOREY_HEIGHT
            for wall in (*storey.outer, *storey.inner):
                for doorway in (opening for opening in wall.openings if opening.is_doorway):
                    assert (doorway.width, doorway.top) == (DOOR_WIDTH, DOOR_HEIGHT)
                    place = middle_of(wall, doorway)
                    assert is_clear(game_map.world, *_at(site, place, floor))


def _at(site: Site, place: tuple[float, float], height: float) -> tuple[float, float, float]:
    x, z = site.pose.outside(*place)
    return x, height, z


@pytest.mark.parametrize("seed", SEEDS)
def test_openings_are_open_and_walls_are_not(seed: int) -> None:
    game_map, houses = houses_of(seed)

    for plan, site in houses:
        for level, storey in enumerate(plan.storeys):
            floor = site.ground + FLOOR_LIFT + level * STOREY_HEIGHT
            for wall in storey.outer:
                for opening in wall.openings:
                    place = middle_of(wall, opening)
                    assert is_open(game_map, site, wall, place, floor + opening.bottom + 0.05)
                    assert is_open(game_map, site, wall, place, floor + opening.top - 0.05)
                    assert not is_open(game_map, site, wall, place, floor + opening.top + 0.05)


@pytest.mark.parametrize("seed", range(20))
def test_a_plan_has_doors_windows_and_rooms(seed: int) -> None:
    plan = draw_plan(seed, 0, (1, 4))

    doors = [[opening for opening in wall.openings if opening.is_doorway] for wall in plan.storeys[0].outer]
    assert len(doors[0]) == 1  # at the front
    assert len(doors[1]) == (plan.size[0] * plan.size[1] > 95.0)  # larger houses have a back door
    for storey in plan.storeys:
        assert storey.inner
        windows = [opening for wall in storey.outer for opening in wall.openings if not opening.is_doorway]
        assert len(windows) >= 3
        assert min(window.width for window in windows) >= 0.8
        for wall in (*storey.outer, *storey.inner):
            ends = [
                place
                for opening in wall.openings
                for place in (opening.middle - opening.width / 2.0, opening.middle + opening.width / 2.0)
            ]
            assert ends == sorted(ends), "openings overlap"


@pytest.mark.parametrize("seed", range(20))
def test_stairs_leave_room_at_both_ends_and_never_lie_above_each_other(seed: int) -> None:
    plan = draw_plan(seed, 0, (4, 4))
    flights = [storey.flight for storey in plan.storeys if storey.flight]

    assert len(flights) == 3
    for flight in flights:
        assert flight.outline.right - flight.outline.left >= 1.3
        assert flight.outline.back - plan.room.back >= LANDING - 1e-9
        assert plan.room.front - flight.outline.front >= LANDING - 1e-9
        assert flight.outline.front - flight.outline.back == pytest.approx((STEPS - 1) * GOING)
    for lower, upper in pairwise(flights):
        assert lower.outline.left != upper.outline.left
    assert pytest.approx(STOREY_HEIGHT) == STEPS * RISE


@pytest.mark.parametrize("seed", SEEDS)
def test_there_is_head_room_over_every_step(seed: int) -> None:
    game_map, houses = houses_of(seed)
    world = game_map.world

    steps = 0
    for solid in np.flatnonzero(world.solid_kind == Kind.STAIR):
        x, _, z = (world.solid_low[solid] + world.solid_high[solid]) / 2.0
        top = world.solid_high[solid, 1]
        assert cast_ray(world, x, top + 0.01, z, 0.0, 1.0, 0.0, 50.0).distance >= HEAD_ROOM
        steps += 1
    assert steps == sum(len(plan.storeys) - 1 for plan, _ in houses) * (STEPS - 1)
    assert HEAD_ROOM > BODY_HEIGHT + RISE


def test_a_floor_goes_around_its_hole() -> None:
    area, hole = Rectangle(0.0, 0.0, 10.0, 8.0), Rectangle(0.0, 2.0, 2.0, 6.0)

    assert around_hole(area, None) == [area]
    assert sum(part.area for part in around_hole(area, hole)) == area.area - hole.area
    assert len(around_hole(area, hole)) == 3
