"""The oracle: it knows the map, and what it reaches is the most that anyone can."""

import numpy as np
import pytest

from wildscav_engine.envs import SingleEnv
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.pools import numbered_maps
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.map_spec import Country, MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.tracks.navigation import spl_of
from wildscav_evaluator.suites.suite import suite
from wildscav_training.opponents import Oracle
from wildscav_training.opponents.oracle import without_edge

VILLAGE = MapSpec(config=MapConfig(size=80, houses=3, storeys=(2, 2), vegetation=0.6), seed=3)
MAZE = MapSpec(config=MapConfig(size=100, houses=0, country=Country(towns=0)), seed=4)


def played(spec: MatchSpec) -> Batch:
    """A match with the oracle in its first seat, until it is over."""
    batch, oracle = Batch([spec]), Oracle()
    match, seat = np.zeros(1, np.int64), np.zeros(1, np.int64)
    oracle.begin(batch, match, seat)
    rows = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    while not batch.state.matches.over[0]:
        rows[0, 0] = oracle.act(batch, match, seat)[0]
        batch.step(rows)
    return batch


@pytest.mark.parametrize("game_map", [VILLAGE, MAZE], ids=["village", "maze"])
@pytest.mark.parametrize("seed", [1, 2])
def test_it_takes_the_shortest_way(game_map: MapSpec, seed: int) -> None:
    spec = MatchSpec(track="navigation", map=game_map, seed=seed, time_limit=60.0, frames_per_action=1)

    batch = played(spec)

    assert batch.state.agents.reached[0, 0]
    assert spl_of(MatchInBatch(batch, 0), [0]) > 0.97


def test_it_knows_a_hidden_target() -> None:
    batch = played(MatchSpec(track="capture", map=VILLAGE, seats=(SUBMISSION, "seeker"), seed=5))

    assert batch.state.agents.reached[0, 0]


def test_it_plays_no_track_without_a_target() -> None:
    with pytest.raises(ValueError, match="the oracle plays navigation and capture, not battle"):
        SingleEnv("battle", opponents=(Oracle(),), map=VILLAGE.config, time_limit=2.0)


def test_an_edge_that_fails_is_forgotten_in_one_direction() -> None:
    graph = map_of(VILLAGE).graph
    node = int(np.argmax((graph.nodes.edges >= 0).all(axis=1)))
    other = int(graph.nodes.edges[node, 0])
    here, there = graph.positions([node, other])

    less = without_edge(graph, here, there)

    assert np.argwhere(less.nodes.edges != graph.nodes.edges).tolist() == [[node, 0]]
    assert other not in less.nodes.edges[node]
    assert without_edge(less, here, there) is less, "there is nothing left to forget"


@pytest.mark.slow
def test_a_gap_in_the_floor_that_the_graph_does_not_know_does_not_hold_it_up() -> None:
    # Three places of a straight way over a rock have a floor, but not all between them.
    spec = MatchSpec(
        track="navigation",
        map=numbered_maps((102,))[0].spec,
        start=(71.0, 4.22329329, -45.0),
        target=(-26.0, 8.8852404, -29.0),
        time_limit=60.0,
        frames_per_action=1,
    )

    assert played(spec).state.agents.reached[0, 0]


@pytest.mark.slow
@pytest.mark.parametrize(("track", "seed", "number"), [("navigation", 0, 8), ("capture", 2, 23)])
def test_a_corner_at_which_it_is_a_centimetre_short_does_not_hold_it_up(
    track: str, seed: int, number: int
) -> None:
    assert played(suite(track, "wild", seed)[number]).state.agents.reached[0, 0]
