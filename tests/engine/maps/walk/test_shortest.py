"""The length of the shortest way, against exact lengths on level ground and a finer search on real maps."""

import itertools
import math

import numpy as np
import pytest
from tests.builders import box, flat_world, random_map_config
from tests.engine.maps.walk.corner_paths import free_places, rectangles, shortest_by_corners, walls
from tests.engine.maps.walk.fine_reference import reference_length
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.world import Solid
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.walk import build_graph, find_path, shortest_length
from wildscav_engine.maps.walk.fine_search import Goal
from wildscav_engine.maps.walk.shortest import finer_path
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.map_spec import MapConfig

Place = tuple[float, float, float]


def length_among(solids: list[Solid], start: Place, target: Place, reach: float = 1.0) -> float:
    return shortest_length(build_graph(flat_world(solids=solids)), start, target, reach)


def test_over_open_ground_it_is_the_straight_line_to_where_the_target_counts() -> None:
    assert length_among([], (-15.3, 0, -11.2), (14.7, 0, 8.9)) == pytest.approx(
        math.dist((30, 20.1), (0, 0)) - 1
    )


def test_whoever_starts_at_the_target_has_no_way_to_go() -> None:
    assert length_among([], (3.0, 0, 4.0), (3.5, 0, 4.0)) == 0


@pytest.mark.parametrize("middle", [0.13, 0.4, 0.61, 0.77])
def test_through_a_gap_as_narrow_as_a_door_wherever_it_is(middle: float) -> None:
    # The gap is 1.2 m wide, and a body 0.9 m. Round the ends it is more than twice as far.
    west, east = box((-19, 0, -0.2), (middle - 0.6, 3, 0.2)), box((middle + 0.6, 0, -0.2), (19, 3, 0.2))
    exact = shortest_by_corners(
        [(-19, -0.2, middle - 0.6, 0.2), (middle + 0.6, -0.2, 19, 0.2)], (-8, -6), (8, 7), BODY_RADIUS
    )
    assert length_among([west, east], (-8, 0, -6), (8, 0, 7)) <= 1.02 * (exact - 1)


def test_a_target_behind_a_thin_wall_counts_from_before_it() -> None:
    wall = box((-12, 0, -0.05), (12, 3, 0.05))
    assert length_among([wall], (0, 0, -9), (0, 0, 0.49)) == pytest.approx(9 + 0.49 - 1, abs=0.03)


@pytest.mark.parametrize("seed", [7, 13, 22, 25, 35, 36])
def test_no_way_among_walls_is_two_percent_shorter(seed: int) -> None:
    blocks = rectangles(seed)
    graph = build_graph(flat_world(solids=walls(blocks)))
    for start, end in itertools.pairwise(free_places(blocks, seed)[:7]):
        exact = shortest_by_corners(blocks, start, end, BODY_RADIUS + 0.15)
        length = shortest_length(graph, (start[0], 0, start[1]), (end[0], 0, end[1]), 0.5)
        assert length <= 1.02 * max(0.0, exact - 0.5)


@pytest.mark.parametrize("seed", [13, 22, 35])
def test_the_way_over_the_fine_grid_can_be_walked(seed: int) -> None:
    blocks = rectangles(seed)
    graph = build_graph(flat_world(solids=walls(blocks)))
    for start, end in itertools.pairwise(free_places(blocks, seed)[:7]):
        goal = Goal(np.array((end[0], 0.0, end[1])), 0.5, 80.0)
        path = finer_path(graph, np.array((start[0], 0.0, start[1])), goal)
        assert path is not None
        turns, leaps = path
        assert not leaps.any()
        walker = Walker(graph.world, start[0], 0.0, start[1])
        assert all(walker.walk_to(x, z, 5.0) for x, _, z in turns.tolist()), (start, end)
        assert math.dist(walker.position[0], goal.target) <= 0.55


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_way_on_a_map_is_two_percent_shorter(seed: int) -> None:
    config = random_map_config(seed, steepest=1.4).model_copy(update={"size": 60, "houses": 1 + seed % 3})
    game_map = generate_map(config, seed)
    dice, places = RandomStream(seed, Stream.TARGET), np.concatenate([game_map.outdoor, game_map.indoor])
    for _ in range(3):
        start, target = (places[dice.integer(0, len(places) - 1)] for _ in range(2))
        length = shortest_length(game_map.graph, start, target, 1.0)
        exact = reference_length(game_map.world, start, target, 1.0, 1.05 * length + 1.0)
        assert length <= 1.02 * exact + 0.02, (start, target, length, exact)
        path = find_path(game_map.graph, start, target)
        assert path is not None
        assert length <= path.length


def test_equal_maps_and_repeated_calls_give_equal_lengths() -> None:
    one, other = (generate_map(MapConfig(size=60, houses=2, vegetation=1.0), 5) for _ in range(2))
    for start, target in itertools.pairwise(one.outdoor[:280:40]):
        length = one.shortest_length(start, target, 1.0)
        assert length == one.shortest_length(start, target, 1.0)
        assert length == shortest_length(other.graph, start, target, 1.0)
