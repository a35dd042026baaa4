"""Robots play: they find supplies, they fight, and they never act beyond the rules."""

import numpy as np
import pytest

from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.match import Match
from wildscav_engine.robots import ROBOTS
from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=80, houses=3), 2)


def play(country: GameMap, *seats: str, seed: int = 0, track: str = "battle") -> Match:
    match = Match(MatchSpec(track=track, map=country.spec, seed=seed, seats=seats, time_limit=60), country)
    match.play_out()
    return match


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_walks_about_and_keeps_to_the_rules(country: GameMap, name: str) -> None:
    match = play(country, *[name] * 4)
    assert match.state.agents.walked[0].min() > 50
    actions = np.array(match.actions_played)
    assert np.isfinite(actions).all()
    assert actions[..., 1].max() <= 10


def test_gatherers_gather_and_walkers_do_not(country: GameMap) -> None:
    match = play(country, "gatherer", "walker", track="gathering")
    assert match.state.agents.supplies[0, 0] > 10
    assert match.state.agents.supplies[0, 1] == 0


def test_gatherers_do_not_stay_at_a_box_that_they_cannot_reach() -> None:
    spec = MapSpec(config=MapConfig(size=100, houses=4, density="high", storeys=(2, 3)), seed=1)
    match = Match(MatchSpec(track="gathering", map=spec, seats=("gatherer",) * 8, time_limit=60))
    ways = []
    while not match.over:
        match.step()
        ways.append(match.state.agents.position[0].copy())

    quarters = np.array(ways)[:600].reshape(4, 150, 8, 3)  # of 15 s each
    extents = np.ptp(quarters, axis=1).max(axis=-1)
    assert extents.min() > 2.0


def test_fighters_kill_each_other(country: GameMap) -> None:
    match = play(country, *["fighter"] * 8)
    assert match.state.agents.kills[0].sum() >= 3
    assert match.state.agents.hits[0].sum() < match.state.agents.shots[0].sum()


def test_a_robot_does_what_it_does_whatever_was_sent_for_its_seat(country: GameMap) -> None:
    spec = MatchSpec(track="battle", map=country.spec, seats=("fighter", "gatherer"), time_limit=10)
    calm, loud = Match(spec, country), Match(spec, country)
    for _ in range(50):
        calm.step()
        loud.step(np.full((2, 8), 7, np.float32))
    assert calm.digest == loud.digest


def test_robots_have_numbers_of_their_own() -> None:
    numbers = [robot.number for robot in ROBOTS.values()]
    assert len(set(numbers)) == len(numbers)
    assert 0 not in numbers  # that is a submission
