"""The places for agents and supplies: mutually reachable, outdoors and indoors."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import box, flat_world

from wildscav_engine.geometry.clearance import has_clearance, is_clear
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.maps import GameMap, House, generate_map
from wildscav_engine.maps.locations import (
    CEILING,
    HIGH_SPACING,
    INDOOR_SPACING,
    Places,
    choose_places,
    is_covered,
    keep_apart,
)
from wildscav_engine.maps.walk import build_graph
from wildscav_engine.specs.map_spec import MapConfig

CONFIGS = [
    MapConfig(size=80, houses=4, storeys=(1, 3), water=0.2, vegetation=1.0),
    MapConfig(size=100, houses=5, storeys=(2, 4), density="high", relief=1.8, ruggedness=0.8),
]
PLANTS = (Kind.TRUNK, Kind.CROWN, Kind.BUSH)


@pytest.fixture(scope="module", params=[0, 1])
def game_map(request: pytest.FixtureRequest) -> GameMap:
    return generate_map(CONFIGS[request.param], request.param)


def are_covered(world: World, places: np.ndarray) -> list[bool]:
    return is_covered(world, places, np.arange(len(world.solid_kind))).tolist()


def places_of(world: World) -> Places:
    return choose_places(build_graph(world), (), np.full(len(world.solid_kind), -1, np.int16), 1)


def in_room(house: House, level: int, places: np.ndarray) -> np.ndarray:
    """Return which places are between the storey's floor and its ceiling, inside the house's walls."""
    across, along = house.pose.inside(places[:, 0], places[:, 2])
    storey = (places[:, 1] - house.ground) / house.storey_height
    inside = np.zeros(len(places), bool)
    for wing in house.wings:
        inside |= wing.holds(across, along)
    return inside & (storey > level - 0.05) & (storey < level + 0.95)


def test_every_place_can_be_reached_from_every_other(game_map: GameMap) -> None:
    graph = game_map.graph
    joined = {tuple(place) for place in graph.positions(np.nonzero(graph.connected)[0]).tolist()}

    for place in (*game_map.outdoor.tolist(), *game_map.indoor.tolist(), *game_map.world.spawns.tolist()):
        assert tuple(place) in joined


def test_a_body_has_room_at_every_place(game_map: GameMap) -> None:
    for x, y, z in np.concatenate([game_map.outdoor, game_map.indoor]):
        assert has_clearance(game_map.world, x, y, z, 0.0)
        assert y >= ground_at(game_map.world, x, z).height - 1e-9
        assert max(abs(x), abs(z)) <= game_map.config.size / 2 - 1.0


def test_places_on_the_ground_are_dry_gentle_and_clear(game_map: GameMap) -> None:
    for x, y, z in game_map.world.spawns:
        assert is_clear(game_map.world, x, y, z)
        ground = ground_at(game_map.world, x, z)
        assert y == pytest.approx(ground.height, abs=0.05)
        assert np.hypot(ground.slope_x, ground.slope_z) < 0.7003  # 35°
        assert np.isneginf(water_at(game_map.world, x, z))


def test_high_places_lie_under_the_open_sky_and_off_the_ground(game_map: GameMap) -> None:
    world = game_map.world
    high = game_map.outdoor[len(world.spawns) :]

    assert len(high) > 0
    for x, y, z in high:
        assert y > ground_at(world, x, z).height + 0.05
        above = raycast(world, x, y + 1.0, z, 0.0, 1.0, 0.0, CEILING).solid
        assert above < 0 or world.solid_kind[above] in PLANTS


def test_no_indoor_place_is_on_a_table_or_a_stair(game_map: GameMap) -> None:
    in_houses = 0
    for house in game_map.houses:
        for level in range(house.storeys):
            on_storey = game_map.indoor[in_room(house, level, game_map.indoor)]
            off_floor = on_storey[:, 1] - house.ground - level * house.storey_height
            assert np.abs(off_floor).max() < 0.1
            in_houses += len(on_storey)
    assert in_houses > 0.9 * len(game_map.indoor)


def test_no_outdoor_place_is_in_a_house(game_map: GameMap) -> None:
    for house in game_map.houses:
        for level in range(house.storeys):
            inside = game_map.outdoor[in_room(house, level, game_map.outdoor)]
            # At most on a lower part's roof.
            assert not any(are_covered(game_map.world, inside))


def least_distance(places: np.ndarray) -> float:
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return float(apart.min(initial=np.inf))


def test_high_places_and_those_in_a_room_keep_their_distance(game_map: GameMap) -> None:
    assert least_distance(game_map.outdoor[len(game_map.world.spawns) :]) >= HIGH_SPACING - 1e-9
    for house in game_map.houses:
        across, along = house.pose.inside(game_map.indoor[:, 0], game_map.indoor[:, 2])
        for level, area in house.rooms:
            within = area.holds(across, along)
            places = game_map.indoor[within & in_room(house, level, game_map.indoor)]
            assert least_distance(places) >= INDOOR_SPACING - 1e-9


def test_the_same_seed_gives_the_same_places_and_another_one_others(game_map: GameMap) -> None:
    chosen = [
        choose_places(game_map.graph, game_map.houses, game_map.solid_house, seed) for seed in (7, 7, 8)
    ]

    for first, again, other in zip(*chosen, strict=True):
        assert first.tolist() == again.tolist()
        assert first.tolist() != other.tolist()


def test_there_are_no_places_behind_a_wall_that_nobody_can_pass() -> None:
    # A wall from edge to edge: 16 m of the map lie west of it, 23 m east.
    places = places_of(flat_world(solids=[box((-4, -1, -30), (-3, 3, 30))]))

    assert len(places.ground) > 20
    assert places.ground[:, 0].min() > -3.0
    assert len(places.indoor) == 0


def test_a_rock_that_can_be_jumped_onto_has_a_place_and_a_higher_one_none() -> None:
    low = box((-6, -1, -3), (-2, 1, 3), Kind.ROCK)
    high = box((2, -1, -3), (6, 2.5, 3), Kind.ROCK)
    places = places_of(flat_world(solids=[low, high])).high

    assert len(places) > 0
    assert places[:, 1] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(
    ("kind", "low", "covered"),
    [
        (Kind.FLOOR, 2.5, True),
        (Kind.ROOF, 7.5, True),
        (Kind.FLOOR, 12.0, False),  # far too high to be a ceiling
        (Kind.CROWN, 2.5, False),  # a place under a tree is outdoors
    ],
)
def test_what_has_a_ceiling_is_indoors(kind: Kind, low: float, covered: bool) -> None:
    world = flat_world(solids=[box((-5, low, -5), (5, low + 0.2, 5), kind)])

    assert are_covered(world, np.array([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0]])) == [covered, False]


COORDINATE = st.floats(-20.0, 20.0)


@given(
    places=st.lists(st.tuples(COORDINATE, COORDINATE, COORDINATE), max_size=60), spacing=st.floats(1.0, 9.0)
)
def test_what_keeps_apart_is_as_much_as_can(places: list[tuple[float, float, float]], spacing: float) -> None:
    given_places = np.array(places, float).reshape(-1, 3)
    kept = keep_apart(given_places, spacing)

    for index, place in enumerate(kept):
        assert all(np.linalg.norm(place - other) >= spacing - 1e-9 for other in kept[:index])
    for place in given_places:  # every place is kept or too near to a kept one
        assert np.linalg.norm(kept - place, axis=1).min() < spacing + 1e-9
