"""Robots play: they find supplies, they fight, and they never act beyond the rules."""

from typing import Any

import numpy as np
import pytest
from tests.builders import flat_world, map_from, place

from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import NAMED, Rules
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=80, houses=3), 2)


def play(country: GameMap, *seats: str, track: str = "battle", **more: Any) -> Match:
    match = Match(MatchSpec(track=track, map=country.spec, seats=seats, time_limit=60, **more), country)
    match.play_out()
    return match


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_walks_about_and_keeps_to_the_rules(country: GameMap, name: str) -> None:
    match = play(country, *[name] * 4)
    assert match.state.agents.walked[0].min() > 50
    actions = np.array(match.actions_played)
    assert np.isfinite(actions).all()
    assert actions[..., 1].max() <= 10


def test_gatherers_gather_and_fighters_kill_each_other_and_walkers_do_neither(country: GameMap) -> None:
    supplies = play(country, "gatherer", "walker", track="gathering").state.agents.supplies[0]
    assert supplies[0] > 10
    assert supplies[1] == 0
    agents = play(country, *["fighter"] * 8).state.agents
    assert agents.kills[0].sum() >= 3
    assert agents.hits[0].sum() < agents.shots[0].sum()


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


@pytest.mark.parametrize(
    ("robot", "far", "near"),
    [
        ("fighter-easy", 3.0, 3.0),  # so slow that its walk hardly matters
        ("fighter", 4.6, 6.0),  # two halves of the enemy may be missed
        ("fighter-hard", 1.8, 7.0),
    ],
)
def test_robots_circle_as_fast_as_their_shots_still_hit(robot: str, far: float, near: float) -> None:
    """At 20 m half of an enemy is 1.29° wide: 2.58 times the spread of the fair rules."""
    for rules, distance, speed in (
        (NAMED["fair"], 20.0, far),
        (NAMED["fair"], 4.0, near),
        (Rules(), 20.0, near),
    ):
        spec = MatchSpec(track="battle", seats=(robot, "submission"), rules=rules)
        match = Match(spec, map_from(flat_world(80)))
        place(match, 0, (0, 0, 0))
        place(match, 1, (0, 0, distance))
        match.step()
        assert match.actions_played[0][0, Field.WALK_SPEED] == pytest.approx(speed, abs=0.1)


def duel(one: str, other: str, matches: int, rules: Rules) -> list[int]:
    """Return how often each of two fighters on open ground killed the other."""
    world = map_from(flat_world())
    kills = np.zeros(2, int)
    for seed in range(matches):
        rules = rules._replace(respawn_time=1, invincible_time=1, spare_ammo=10_000)
        seats = (one, other) if seed % 2 else (other, one)
        spec = MatchSpec(track="battle", map=world.spec, seed=seed, seats=seats, time_limit=60, rules=rules)
        match = Match(spec, world)
        match.play_out()
        kills += match.state.agents.kills[0][:: 1 if seed % 2 else -1]
    return kills.tolist()


@pytest.mark.parametrize("rules", NAMED)
@pytest.mark.parametrize(("better", "worse"), [("fighter", "fighter-easy"), ("fighter-hard", "fighter")])
def test_a_better_fighter_kills_more_often_than_it_dies(better: str, worse: str, rules: str) -> None:
    wins, losses = duel(better, worse, 20, NAMED[rules])
    assert wins > 1.1 * losses


def test_a_better_gatherer_has_more_supplies_in_the_end() -> None:
    world = map_from(flat_world())
    totals = []
    for kind in ("gatherer-easy", "gatherer", "gatherer-hard"):
        matches = [
            Match(MatchSpec(track="gathering", seed=seed, seats=(kind,), time_limit=4), world)
            for seed in range(12)
        ]
        for match in matches:
            match.play_out()
        totals.append(sum(int(match.state.agents.supplies.sum()) for match in matches))
    assert totals == sorted(set(totals))


def test_a_better_seeker_is_at_the_target_sooner() -> None:
    world = map_from(flat_world())
    frames = []
    ends: dict[str, Any] = {"start": (-15, 0, -15), "target": (15, 0, 9)}
    for kind in ("seeker-easy", "seeker", "seeker-hard"):
        match = play(world, kind, track="navigation", **ends)
        assert match.result().ending == "goal"
        frames.append(match.frame)
    assert frames == sorted(frames, reverse=True)


def test_seekers_find_a_hidden_target(country: GameMap) -> None:
    played = [play(country, *["seeker-hard"] * 4, seed=seed, track="capture") for seed in range(6)]
    assert [match.result().ending for match in played].count("goal") >= 3


@pytest.mark.parametrize("name", ["walker", "gatherer", "fighter"])
def test_robots_stay_in_the_safe_zone(country: GameMap, name: str) -> None:
    zone = ZoneConfig(phases=(ZonePhase(wait=0, shrink=5, share=0.3, damage=1),))
    match = play(country, *[name] * 4, track="royale", teams=(0,) * 4, zone=zone)
    # One or the other may get stuck on its way.
    assert match.state.agents.health[0].mean() > 70
