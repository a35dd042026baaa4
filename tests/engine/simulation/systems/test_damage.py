"""Rulings on death and what comes after."""

import pytest
from tests.builders import act, place
from tests.builders import duel as made_duel

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.rules import Rules


def duel(**rules: float) -> Match:
    return made_duel(rules=Rules(**{"shot_damage": 100, **rules}))


@pytest.mark.parametrize(
    ("health", "left"),
    [
        (100, 80),  # a hit is a hit
        (20, 0),  # exactly enough
        (10, 0),  # overkill stops at zero
    ],
)
def test_damage(health: int, left: int) -> None:
    match = duel(shot_damage=20)
    match.state.agents.health[0, 1] = health
    act(match, 1, seat_0={"shoot": 1})
    assert match.state.agents.health[0, 1] == left


def test_two_agents_can_kill_each_other_in_one_frame() -> None:
    match = duel()
    act(match, 1, seat_0={"shoot": 1}, seat_1={"shoot": 1})
    assert match.state.agents.health[0].tolist() == [0, 0]
    assert match.state.agents.kills[0].tolist() == [1, 1]
    assert match.state.agents.deaths[0].tolist() == [1, 1]


def test_the_dead_come_back_after_500_frames_with_everything_but_half_their_supplies() -> None:
    match = made_duel(rules=Rules(shot_damage=100), frames_per_action=1)
    agents = match.state.agents
    agents.supplies[0, 1] = 31
    act(match, 1, seat_0={"shoot": 1})
    act(match, 499)
    assert agents.health[0, 1] == 0
    act(match, 1)
    assert (agents.health[0, 1], agents.invincible_left[0, 1], agents.supplies[0, 1]) == (100, 500, 16)
    assert (agents.clip[0, 1], agents.spare_ammo[0, 1]) == (15, 60)
    assert match.game_map.outdoor.tolist().count(agents.position[0, 1].tolist()) == 1


def test_the_dead_do_nothing_and_are_no_obstacle() -> None:
    match = duel()
    act(match, 1, seat_0={"shoot": 1})
    act(match, 20, seat_0={"walk_speed": 8}, seat_1={"walk_speed": 8, "shoot": 1})
    assert match.state.agents.position[0, 0, 2] == pytest.approx(16)
    assert match.state.agents.position[0, 1, 2] == 10
    assert match.state.agents.shots[0, 1] == 0


def test_whoever_came_back_cannot_be_hurt_for_10_seconds() -> None:
    match = duel(respawn_time=1.0)
    act(match, 1, seat_0={"shoot": 1})
    act(match, 10)
    place(match, 1, (0, 0, 10))
    act(match, 40, seat_0={"shoot": 1})
    assert match.state.agents.health[0, 1] == 100
    assert match.state.agents.hits[0, 0] > 1  # hits they are all the same
    act(match, 70)
    place(match, 1, (0, 0, 10))
    match.state.agents.clip[0, 0] = 15
    act(match, 2, seat_0={"shoot": 1})
    assert match.state.agents.health[0, 1] == 0


def test_a_kill_brings_a_bounty_besides_what_is_dropped_where_the_agent_died() -> None:
    match = duel(bounty=7)
    agents, boxes = match.state.agents, match.state.supplies
    boxes.quantity[:] = 0
    agents.supplies[0] = 1, 10
    act(match, 1, seat_0={"shoot": 1})
    assert agents.supplies[0].tolist() == [8, 5]
    assert agents.gained[0, 0] == 0
    slot = int(boxes.quantity[0].argmax())
    assert (boxes.quantity[0, slot], boxes.quantity.sum()) == (5, 5)
    assert boxes.position[0, slot] == pytest.approx([0, 0, 10])
    act(match, 20, seat_0={"walk_speed": 5, "pick_up": 1})
    assert agents.supplies[0, 0] == 13


@pytest.mark.parametrize("seed", range(4))
def test_who_dies_first_in_a_frame_makes_no_difference_for_bounties(seed: int) -> None:
    match = made_duel(seed=seed, rules=Rules(shot_damage=100, bounty=20, supply_loss=0.25))
    match.state.agents.supplies[0] = 40
    act(match, 1, seat_0={"shoot": 1}, seat_1={"shoot": 1})
    assert match.state.agents.supplies[0].tolist() == [50, 50]
