"""Paths are valid: an agent that follows one with the engine's own motion arrives."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import box, flat_world
from tests.engine.maps.walk.corner_paths import free_places, rectangles, shortest_by_corners, walls
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.maps import GameMap, MapError, generate_map
from wildscav_engine.maps.walk import build_graph, find_path
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.map_spec import MapConfig

SPEEDS = (3.0, 5.0, 10.0)  # m/s

configs = st.builds(
    MapConfig,
    size=st.integers(30, 45).map(lambda half: 2 * half),
    houses=st.integers(0, 3),
    storeys=st.sampled_from([(1, 1), (1, 4), (2, 3)]),
    density=st.sampled_from(["low", "high"]),
    relief=st.floats(0.0, 2.0),
    ruggedness=st.floats(0.0, 1.0),
    water=st.floats(0.0, 0.3),
    vegetation=st.floats(0.0, 1.0),
)


@settings(max_examples=8)
@given(config=configs, seed=st.integers(0, 2**64 - 1))
def test_every_path_between_places_of_any_map_is_walked_to_its_end(config: MapConfig, seed: int) -> None:
    try:
        game_map = generate_map(config, seed)
    except MapError:  # steep and wet, and more houses than fit
        return
    dice = RandomStream(seed, Stream.TARGET)
    places = np.concatenate([game_map.outdoor, game_map.indoor])
    for number in range(6):
        start, end = (places[dice.integer(0, len(places) - 1)] for _ in range(2))
        path = find_path(game_map.graph, start, end)
        assert path is not None, f"no way from {start} to {end}"
        assert path.length >= math.dist(start[::2], end[::2]) - 1e-9
        walker = Walker(game_map.world, *path.start)
        assert walker.follow(path, SPEEDS[number % 3]), (
            f"seed {seed}: from {start} to {end}: stuck at {walker.position[0]}"
        )


@pytest.mark.parametrize("seed", [7, 13, 22, 25, 35, 36])
def test_no_way_with_room_is_more_than_a_percent_shorter_than_a_path(seed: int) -> None:
    blocks = rectangles(seed)
    graph = build_graph(flat_world(solids=walls(blocks)))
    free = free_places(blocks, seed)
    for start, end in itertools.pairwise(free[:7]):
        path = find_path(graph, (start[0], 0, start[1]), (end[0], 0, end[1]))
        assert path is not None
        assert path.length <= 1.01 * shortest_by_corners(blocks, start, end, BODY_RADIUS + 0.25)
        assert path.length >= shortest_by_corners(blocks, start, end, BODY_RADIUS) - 1e-6


@pytest.fixture(scope="module")
def game_map() -> GameMap:
    return generate_map(MapConfig(size=60, houses=1), 5)


def test_the_length_of_a_path_is_what_an_agent_walks(game_map: GameMap) -> None:
    path = find_path(game_map.graph, game_map.indoor[-1], game_map.outdoor[0])
    assert path is not None
    walked, walker = 0.0, Walker(game_map.world, *path.start)
    for leg in path.legs:
        before = walker.position[0].copy()
        assert walker._go(leg, 5.0)
        walked += math.dist(before[::2], walker.position[0, ::2])
    assert walked == pytest.approx(path.length, rel=0.01)


def test_a_path_that_is_not_straightened_goes_from_node_to_node_and_is_walked_to_its_end(
    game_map: GameMap,
) -> None:
    start, end = game_map.outdoor[0], game_map.indoor[-1]
    path, straight = (find_path(game_map.graph, start, end, straight=wanted) for wanted in (False, True))
    assert path is not None
    assert straight is not None
    nodes = {tuple(place) for place in game_map.graph.positions().tolist()}
    assert all(leg.end in nodes for leg in path.legs[:-1])
    assert len(path.legs) > len(straight.legs)
    assert path.length >= straight.length
    assert Walker(game_map.world, *path.start).follow(path, 5.0)


def test_there_is_no_path_to_where_nobody_can_stand() -> None:
    graph = build_graph(flat_world(solids=[box((-2, 0, -2), (2, 3, 2))]))
    assert find_path(graph, (-10, 0, 0), (0, 0, 0)) is None
    assert find_path(graph, (-10, 0, 0), (5, 9.0, 5)) is None
