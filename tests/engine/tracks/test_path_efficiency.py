"""Rulings on SPL: success weighted by the length of the shortest way over that of the agent's."""

import math
from typing import Any

import pytest
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.envs import SingleEnv, parallel_env
from wildscav_engine.simulation.match import Match
from wildscav_engine.tracks import metrics_of

WALLED = flat_world(solids=[box((4, 0, -12), (5, 3, 3))])
EAST, NORTH, SOUTH = ({"walk_direction": direction, "walk_speed": 5} for direction in (90, 0, 180))


def spl(match: Match) -> list[float]:
    return [seat.metrics["spl"] for seat in match.result().seats]


# A body keeps 0.45 m from a wall, and the target counts from 1 m away.
ROUND_WALL = math.dist((0, 0), (3.55, 3.45)) + 1.9 + math.dist((5.45, 3.45), (10, 0)) - 1


@pytest.mark.parametrize(
    ("spec", "walks", "wanted"),
    [
        # The target counts after 9.05 m; the frame in which it does ends at 9.1 m.
        ({"target": (10.05, 0, 0)}, ((40, EAST),), 9.05 / 9.1),
        # 9 m are the shortest way; 5 m north and back come on top.
        ({}, ((10, NORTH), (10, SOUTH), (40, EAST)), 9 / 19),
        ({"time_limit": 1.5}, ((40, EAST),), 0.0),  # it does not arrive
        # Around a wall: 4 m, 10 m and 3 m.
        ({"world": WALLED}, ((8, NORTH), (20, EAST), (10, SOUTH)), ROUND_WALL / 17),
    ],
)
def test_it_is_the_shortest_way_over_ones_own(
    spec: dict[str, Any], walks: tuple[tuple[int, dict[str, float]], ...], wanted: float
) -> None:
    match = make_match("navigation", **{"start": (0, 0, 0), "target": (10, 0, 0), **spec})
    for steps, walk in walks:
        act(match, steps, seat_0=walk)
    assert match.over
    assert spl(match) == pytest.approx([wanted], abs=0.01 if "world" in spec else 0.003)


def test_whoever_walked_less_than_the_shortest_way_has_one() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10, 0, 0))
    place(match, 0, (8.5, 0, 0))  # put there by hand
    act(match, 10, seat_0=EAST)
    assert spl(match) == [1.0]


def test_in_a_race_each_seat_has_its_own() -> None:
    match = make_match("navigation", seats=2, target=(10, 0, 0), starts=((0, 0, 0), (10, 0, -12)))
    act(match, 40, seat_0=EAST, seat_1={"walk_direction": 0, "walk_speed": 1})
    assert spl(match) == pytest.approx([1.0, 0.0], abs=0.02)


def test_a_team_is_compared_with_its_member_that_has_the_shortest_way() -> None:
    match = make_match(
        "capture", seats=3, target=(15, 0, 0), starts=((0, 0, 0), (6, 0, 4), (-9, 0, 9)), teams=(0, 0, 1)
    )
    act(match, 60, seat_0=EAST)
    # Seat 0 walks 14 m; seat 1 would have walked less. Seat 2 is on another team.
    shortest = math.dist((6, 4), (15, 0)) - 1
    assert spl(match) == pytest.approx([shortest / 14, shortest / 14, 0.0], abs=0.006)


def test_every_result_has_it_on_tracks_with_a_target_and_on_no_other() -> None:
    with_spl = {"navigation", "capture"}
    for track in ("navigation", "gathering", "capture", "battle", "royale"):
        names = [metric.name for metric in metrics_of(track)]
        assert ("spl" in names) == (track in with_spl)
        match = make_match(track, seats=2, time_limit=0.1)
        act(match, 1)
        assert list(match.result().seats[0].metrics) == names


def test_the_infos_of_environments_have_it_on_request() -> None:
    short: dict[str, Any] = {"sensors": {}, "time_limit": 0.1, "map": 101}
    told = []
    for options in ({}, {"all_metrics": True}):
        env = SingleEnv("navigation", **short, **options)
        env.reset(seed=1)
        told.append(env.step(env.action_space.sample())[-1]["metrics"].get("spl"))
    assert told == [None, 0.0]
    several = parallel_env("capture", **short, all_metrics=True)
    several.reset(seed=1)
    *_, infos = several.step({agent: several.action_space(agent).sample() for agent in several.agents})
    assert all(info["metrics"]["spl"] == 0.0 for info in infos.values())
