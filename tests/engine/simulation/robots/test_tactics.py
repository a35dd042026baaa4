"""What the better robots can do: take cover, feel their way around obstacles, and hunt together."""

from typing import Any

import numpy as np
import pytest
from tests.builders import box, flat_world, lay_boxes, map_from, place

from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.maps import generate_map
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import Equipment, MatchSpec

WALL = box((1.5, 0, 4), (8, 3, 4.5))
ENEMY, ROBOT = (0.0, 0.0, -10.0), (0.0, 0.0, 2.0)  # the wall is a few steps behind the robot, to its right


def under_fire(robot: str, health: int, clip: int) -> Match:
    """A robot of so much health, in sight of an enemy that it cannot kill."""
    world = map_from(flat_world(solids=[WALL]))
    hardy = (Equipment(health=10_000), None)
    match = Match(
        MatchSpec(track="battle", map=world.spec, seats=("submission", robot), equipment=hardy), world
    )
    match.state.supplies.quantity[:] = 0
    place(match, 0, ENEMY)
    place(match, 1, ROBOT, yaw=180.0)
    match.state.agents.health[0, 1], match.state.agents.clip[0, 1] = health, clip
    return match


def is_in_sight(match: Match) -> bool:
    one, two = match.state.agents.position[0].tolist()
    return sight_is_clear(match.game_map.world, one[0], one[1] + EYE_HEIGHT, one[2], two[0], 1.0, two[2])


@pytest.mark.parametrize(
    ("robot", "health", "clip", "hides"),
    [
        ("fighter-hard", 40, 15, True),  # it is weak
        ("fighter-hard", 100, 0, True),  # it has to reload
        ("fighter-hard", 100, 15, False),
        ("fighter", 40, 15, False),
    ],
)
def test_a_hard_fighter_takes_cover_when_it_has_to(
    robot: str, health: int, clip: int, *, hides: bool
) -> None:
    match = under_fire(robot, health, clip)
    hidden = 0
    for _ in range(20):
        match.step()
        hidden += not is_in_sight(match)
    assert (hidden >= 5) == hides


def test_a_hard_fighter_fires_on_its_way_into_cover_and_reloads_there() -> None:
    weak, empty = under_fire("fighter-hard", 40, 15), under_fire("fighter-hard", 100, 0)
    for _ in range(30):
        weak.step()
        empty.step()
    assert weak.state.agents.hits[0, 1] >= 1
    assert empty.state.agents.clip[0, 1] == 15


def squad_of_three(*enemies: tuple[float, float, float], robot: str = "hunter-squad") -> Match:
    world = map_from(flat_world())
    seats, teams = (robot,) * 3 + ("submission",) * len(enemies), (0, 0, 0, *(1,) * len(enemies))
    match = Match(MatchSpec(track="battle", map=world.spec, seats=seats, teams=teams), world)
    match.state.supplies.quantity[:] = 0
    for seat, x in enumerate((-2.0, 0.0, 2.0)):
        place(match, seat, (x, 0.0, 0.0))
    for seat, position in enumerate(enemies):
        place(match, 3 + seat, position)
    return match


def test_a_squad_shoots_at_one_enemy_the_weakest_first() -> None:
    match = squad_of_three((-8.0, 0.0, 14.0), (8.0, 0.0, 14.0))
    health = match.state.agents.health[0]
    health[4] = 60
    while health[4] > 0 and match.frame < 500:
        match.step()
    assert health[4] == 0
    assert health[3] == 100


def test_a_squad_comes_to_an_enemy_that_only_one_of_it_sees() -> None:
    match = squad_of_three((0.0, 0.0, 18.0))
    place(match, 0, (-2.0, 0.0, 0.0), yaw=180.0)
    place(match, 2, (2.0, 0.0, -15.0), yaw=180.0)
    for _ in range(10):
        match.step()
    assert match.state.agents.position[0, 2, 2] > -12.0
    assert match.state.agents.shots[0, 0] > 0


def spread(robot: str) -> float:
    """The mean distance in m of three teammates from the fourth in the second half of a minute."""
    country = generate_map(MapConfig(size=120, houses=2), 4)
    squad: dict[str, Any] = {"seats": (robot,) * 4, "teams": (0,) * 4, "time_limit": 60.0, "seed": 5}
    match, distances = Match(MatchSpec(track="battle", map=country.spec, **squad), country), []
    while not match.over:
        match.step()
        away = match.state.agents.position[0, 1:] - match.state.agents.position[0, 0]
        distances.append(np.hypot(away[:, 0], away[:, 2]).mean())
    return float(np.mean(distances[300:]))


def test_a_squad_keeps_together() -> None:
    assert spread("hunter-squad") < min(20.0, 0.6 * spread("fighter"))


@pytest.mark.parametrize("width", [12.0, 30.0])
def test_a_hard_seeker_finds_its_way_around_a_wide_wall(width: float) -> None:
    wall = box((-width / 2, 0, 0), (width / 2, 3, 0.5))
    world = map_from(flat_world(size=60, solids=[wall]))
    reached = {"seeker": 0, "seeker-hard": 0}
    for robot in reached:
        for seed in range(6):
            ends: dict[str, Any] = {"start": (0, 0, -15), "target": (0, 0, 15), "time_limit": 30.0}
            match = Match(MatchSpec(track="navigation", seats=(robot,), seed=seed, **ends), world)
            match.play_out()
            reached[robot] += match.result().ending == "goal"
    assert reached["seeker-hard"] >= 5
    assert reached["seeker-hard"] >= reached["seeker"]


def searched(robot: str, seats: int, seconds: float) -> float:
    """The share of a bare map of 120 m that a team had in sight in some time, with a target out of reach."""
    world = map_from(flat_world(size=120))
    spec = MatchSpec(track="capture", seats=(robot,) * seats, time_limit=seconds, target=(15, 0, 15))
    match, middles = Match(spec, world), np.arange(-57.5, 60.0, 5.0)
    match.state.matches.target[0] = 0, 500, 0
    seen = np.zeros((len(middles), len(middles)), bool)
    while not match.over:
        match.step()
        for x, _, z in match.state.agents.position[0].tolist():
            seen |= np.hypot(middles[:, None] - x, middles[None, :] - z) < 20.0
    return float(seen.mean())


@pytest.mark.parametrize(("seats", "seconds"), [(1, 75.0), (4, 25.0)])  # 16 squares of 30 m, shared
def test_hard_seekers_search_the_whole_map_one_part_each(seats: int, seconds: float) -> None:
    assert searched("seeker-hard", seats, seconds) > max(0.85, 1.2 * searched("seeker", seats, seconds))


def test_a_squad_shares_the_boxes() -> None:
    match = squad_of_three()
    place(match, 0, (0.0, 0.0, 0.0))
    place(match, 1, (0.0, 0.0, -3.0))
    place(match, 2, (-9.0, 0.0, 0.0))
    # The first box is nearest to both of the first two, the other is left to the second member.
    lay_boxes(match, (0.0, 0.0, 3.0), (6.0, 0.0, -6.0))
    for _ in range(12):
        match.step()
    assert (match.state.agents.picked_up[0] > 0).tolist() == [True, True, False]


def test_a_member_that_is_hit_by_somebody_unseen_looks_all_around() -> None:
    match = squad_of_three()
    match.step()
    match.state.agents.health[0, 0] -= 20
    for _ in range(15):
        match.step()
    turned = np.array(match.actions_played)[1:, :, Field.TURN].sum(axis=0) * match.spec.frames_per_action
    assert turned[0] >= 360.0
    assert (turned[1:] < 360.0).all()


def test_a_member_far_away_comes_to_the_squad_and_not_the_squad_to_it() -> None:
    match = squad_of_three()
    place(match, 0, (-18.0, 0.0, -18.0))
    place(match, 1, (18.0, 0.0, 18.0))
    place(match, 2, (16.0, 0.0, 18.0))
    for _ in range(20):
        match.step()
    (x, _, z), *others = match.state.agents.position[0].tolist()
    assert x + z > -21.0
    assert all(x + z > 0.0 for x, _, z in others)
