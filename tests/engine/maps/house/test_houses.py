"""Built houses: their openings and stairs are open, and maps know their positions."""

import numpy as np
import pytest
from tests.engine.maps.house.built_house import BuiltHouse

from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.house import Opening, Wall, doorsteps, draw_plan
from wildscav_engine.maps.house.build import around_hole, can_be_walked_to
from wildscav_engine.maps.house.plan import Roof
from wildscav_engine.maps.house.stairs import RISE
from wildscav_engine.specs.body import BODY_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig

CONFIG = MapConfig(size=80, houses=4, storeys=(2, 3), vegetation=0.0)
SEEDS = [0, 1]
HEAD_ROOM = 2.2  # m


@pytest.fixture(scope="module", params=range(10))
def house(request: pytest.FixtureRequest) -> BuiltHouse:
    return BuiltHouse(draw_plan(request.param, 0, (1, 4)), yaw=33.0 * request.param)


def openings_of(house: BuiltHouse) -> list[tuple[float, Wall, Opening]]:
    """Return all openings, each with the height of its floor and its wall."""
    return [
        (house.height(level), wall, opening)
        for level, storey in enumerate(house.plan.storeys)
        for wall in (*storey.outer, *storey.inner)
        for opening in wall.openings
    ]


def middle_of(wall: Wall, opening: Opening) -> tuple[float, float]:
    outline = wall.outline
    if wall.is_across:
        return opening.middle, (outline.back + outline.front) / 2.0
    return (outline.left + outline.right) / 2.0, opening.middle


def is_open(house: BuiltHouse, wall: Wall, place: tuple[float, float], height: float) -> bool:
    """Cast a ray of 0.6 m straight through a wall."""
    aside = (0.0, -0.3) if wall.is_across else (-0.3, 0.0)
    x, z = house.site.pose.outside(place[0] + aside[0], place[1] + aside[1])
    end_x, end_z = house.site.pose.outside(place[0] - aside[0], place[1] - aside[1])
    way_x, way_z = (end_x - x) / 0.6, (end_z - z) / 0.6
    return bool(np.isinf(raycast(house.world, x, height, z, way_x, 0.0, way_z, 0.6).distance))


def test_bodies_pass_every_doorway_and_no_window(house: BuiltHouse) -> None:
    for floor, wall, opening in openings_of(house):
        x, z = house.site.pose.outside(*middle_of(wall, opening))
        assert is_clear(house.world, x, floor, z) == opening.is_doorway
        assert opening.is_doorway or opening.top - opening.bottom < BODY_HEIGHT


def test_openings_are_open_and_walls_are_not(house: BuiltHouse) -> None:
    for floor, wall, opening in openings_of(house):
        across, along = middle_of(wall, opening)
        assert is_open(house, wall, (across, along), floor + opening.top - 0.05)
        assert not is_open(house, wall, (across, along), floor + opening.top + 0.05)
        for end in (-1.0, 1.0):
            aside = end * (opening.width / 2.0 - 0.05)
            edge = (across + aside, along) if wall.is_across else (across, along + aside)
            assert is_open(house, wall, edge, floor + opening.top - 0.05)
            aside += end * 0.1
            beyond = (across + aside, along) if wall.is_across else (across, along + aside)
            assert not is_open(house, wall, beyond, floor + 1.5)
        if not opening.is_doorway:
            assert not is_open(house, wall, (across, along), floor + opening.bottom - 0.05)


def test_there_is_head_room_over_every_step_and_landing(house: BuiltHouse) -> None:
    flights = len(house.plan.storeys) - 1 + house.plan.roof_exit
    steps = [solid for solid in house.solids if solid.kind == Kind.STAIR]
    for solid in steps:
        x, _, z = (solid.low + solid.high) / 2.0
        assert raycast(house.world, x, solid.high[1] + 0.01, z, 0.0, 1.0, 0.0, 50.0).distance >= HEAD_ROOM
    turns = house.plan.stairs is not None and house.plan.stairs.landing is not None
    assert len(steps) == flights * (15 if turns else 14)
    assert HEAD_ROOM > BODY_HEIGHT + RISE


def test_nobody_falls_off_a_roof_or_into_stairs_by_walking(house: BuiltHouse) -> None:
    """A ray at knee height outwards from every walkable roof is stopped on all sides."""
    for number, wing in enumerate(house.plan.wings):
        if not can_be_walked_to(house.plan, number):
            continue
        assert wing.roof is Roof.FLAT
        left, back, right, front = wing.inside
        across, along = (left + right) / 2.0, (back + front) / 2.0
        x, z = house.site.pose.outside(across, along)
        for east, north in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            end_x, end_z = house.site.pose.outside(across + east, along + north)
            y = house.height(wing.storeys) + 0.8
            assert raycast(house.world, x, y, z, end_x - x, 0.0, end_z - z, 60.0).distance < 30.0


def test_all_solids_are_within_the_house_and_its_eaves(house: BuiltHouse) -> None:
    half_across, half_along = (size / 2.0 + 0.4 for size in house.plan.size)
    for solid in house.solids:
        middle = house.site.pose.inside(*((solid.low + solid.high) / 2.0)[::2])
        assert abs(middle[0]) < half_across
        assert abs(middle[1]) < half_along
        assert (solid.high - solid.low).min() > 0.01
        assert solid.kind in (Kind.WALL, Kind.FLOOR, Kind.STAIR, Kind.ROOF, Kind.FURNITURE)


def test_few_solids_make_a_storey() -> None:
    plans = [draw_plan(seed, 0, (1, 4)) for seed in range(40)]
    storeys = sum(len(plan.storeys) for plan in plans)

    assert sum(len(BuiltHouse(plan).solids) for plan in plans) < 80 * storeys


def test_doorsteps_are_before_the_doors(house: BuiltHouse) -> None:
    steps = doorsteps(house.plan, house.site, 1.5)

    assert len(steps) == len(house.plan.doors)
    for x, z in steps:
        assert is_clear(house.world, x, 0.0, z)
        place = house.site.pose.inside(x, z)
        near = [
            np.hypot(place[0] - middle_of(wall, door)[0], place[1] - middle_of(wall, door)[1])
            for wall in house.plan.storeys[0].outer
            for door in wall.doorways
        ]
        assert min(near) == pytest.approx(1.5 + 0.125)


@pytest.mark.parametrize("seed", SEEDS)
def test_solids_know_their_house(seed: int) -> None:
    game_map = generate_map(CONFIG, seed)
    world = game_map.world
    middles = (world.solid_low + world.solid_high) / 2.0

    for number, house in enumerate(game_map.houses):
        mine = middles[game_map.solid_house == number]
        assert len(mine) > 50
        reach = np.hypot(house.size[0], house.size[1]) / 2.0
        assert np.hypot(mine[:, 0] - house.center[0], mine[:, 2] - house.center[1]).max() <= reach
    grown = np.isin(world.solid_kind, [Kind.TRUNK, Kind.CROWN, Kind.ROCK, Kind.BUSH])
    assert np.array_equal(grown, game_map.solid_house < 0)


def test_a_floor_goes_around_its_hole() -> None:
    area, hole = Rectangle(0.0, 0.0, 10.0, 8.0), Rectangle(0.0, 2.0, 2.0, 6.0)

    assert around_hole(area, None) == [area]
    assert sum(part.area for part in around_hole(area, hole)) == area.area - hole.area
    assert len(around_hole(area, hole)) == 3
