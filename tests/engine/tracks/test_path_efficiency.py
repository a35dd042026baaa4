"""Rulings on SPL: success weighted by the length of the shortest way over that of the agent's."""

import math
from typing import Any

import pytest
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.envs import SingleEnv, parallel_env
from wildscav_engine.simulation.match import Match
from wildscav_engine.tracks import metrics_of

EAST, NORTH, SOUTH = ({"walk_direction": direction, "walk_speed": 5} for direction in (90, 0, 180))


def spl(match: Match) -> list[float]:
    return [seat.metrics["spl"] for seat in match.result().seats]


def test_whoever_walks_straight_to_the_target_has_one() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10.05, 0, 0))
    act(match, 40, seat_0=EAST)
    assert match.over
    # The target counts after 9.05 m; the frame in which it does ends at 9.1 m.
    assert spl(match) == pytest.approx([9.05 / 9.1])


def test_whoever_makes_a_detour_has_the_shortest_over_its_own_way() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10, 0, 0))
    act(match, 10, seat_0=NORTH)
    act(match, 10, seat_0=SOUTH)
    act(match, 40, seat_0=EAST)
    assert match.over
    # 9 m are the shortest way, as the target counts from 1 m away; 5 m north and back come on top.
    assert spl(match) == pytest.approx([9 / 19], abs=0.003)


def test_whoever_does_not_arrive_has_none_however_short_its_way_was() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10, 0, 0), time_limit=1.5)
    act(match, 40, seat_0=EAST)
    assert match.over
    assert spl(match) == [0.0]


def test_the_shortest_way_leads_round_what_is_in_the_way() -> None:
    wall = box((4, 0, -12), (5, 3, 3))
    match = make_match("navigation", world=flat_world(solids=[wall]), start=(0, 0, 0), target=(10, 0, 0))
    act(match, 8, seat_0=NORTH)  # 4 m
    act(match, 20, seat_0=EAST)  # 10 m
    act(match, 10, seat_0=SOUTH)  # 3 m
    assert match.over
    # A body keeps 0.45 m from the wall, and the target counts from 1 m away.
    shortest = math.dist((0, 0), (3.55, 3.45)) + 1.9 + math.dist((5.45, 3.45), (10, 0)) - 1
    assert spl(match) == pytest.approx([shortest / 17], abs=0.01)


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
    assert "spl" not in _last_metrics({})
    assert _last_metrics({"all_metrics": True})["spl"] == 0.0


def _last_metrics(options: dict[str, Any]) -> dict[str, float]:
    env = SingleEnv("navigation", sensors={}, time_limit=0.1, map=1, **options)
    env.reset(seed=1)
    _, _, terminated, truncated, info = env.step(env.action_space.sample())
    assert terminated or truncated
    return dict(info["metrics"])


def test_several_learners_have_it_in_their_infos() -> None:
    env = parallel_env("capture", sensors={}, time_limit=0.1, map=1, all_metrics=True)
    env.reset(seed=1)
    *_, infos = env.step({agent: env.action_space(agent).sample() for agent in env.agents})
    assert all(info["metrics"]["spl"] == 0.0 for info in infos.values())


def test_a_start_that_is_not_the_place_where_an_agent_is_put_by_hand_counts() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10, 0, 0))
    place(match, 0, (8.5, 0, 0))
    act(match, 10, seat_0=EAST)
    assert match.over
    assert spl(match) == [1.0]  # walked less than the shortest way
