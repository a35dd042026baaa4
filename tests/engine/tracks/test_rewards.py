"""Rulings on what a learner is paid for."""

import numpy as np
import pytest
from tests.builders import act, facts_of, make_match, paid_between, place

from wildscav_engine.simulation.match import Match
from wildscav_engine.tracks import TRACKS
from wildscav_engine.tracks.rewards import FACTS, REWARD_TERMS, RewardSum


def paid(match: Match, *names: str, **seats: dict[str, float]) -> dict[str, list[float]]:
    """Play one step and return what each seat is paid for it, by term."""
    before = facts_of(match)
    act(match, 1, **seats)
    return paid_between(before, facts_of(match), **dict.fromkeys(names, 1.0))


def test_reaching_the_target_pays_once() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(1.5, 0, 0))
    east = {"walk_direction": 90, "walk_speed": 10}
    assert paid(match, "target_reached", seat_0=east) == {"target_reached": [1]}
    assert paid(match, "target_reached", seat_0=east) == {"target_reached": [0]}


def test_coming_nearer_pays_by_the_metre_and_going_away_costs_as_much() -> None:
    match = make_match("navigation", start=(0, 0, 0), target=(10, 0, 0))
    for direction, metres in ((90, 1), (270, -1)):
        told = paid(match, "approach", seat_0={"walk_direction": direction, "walk_speed": 10})
        assert told["approach"] == [pytest.approx(metres)]


def test_a_find_pays_one_however_much_is_in_the_box_and_the_team_shares_its_supplies() -> None:
    match = make_match("gathering", seats=3, teams=(1, 0, 0))
    supplies = match.state.supplies
    supplies.position[0, 0] = match.state.agents.position[0, 2]
    supplies.quantity[0, 0], supplies.appears[0, 0] = 7, 0
    pays = paid(match, "supply_found", "supplies", "team_supplies", seat_2={"pick_up": 1})
    assert pays == {"supply_found": [0, 0, 1], "supplies": [0, 0, 7], "team_supplies": [0, 7, 7]}


def test_a_hit_pays_the_shooter_and_costs_the_other() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0), yaw=0)
    place(match, 1, (0, 0, 6))
    match.state.agents.health[0, 1] = 20
    pays = paid(match, "hit", "kill", "death", "damage_taken", seat_0={"shoot": 1})
    assert pays == {"hit": [1, 0], "kill": [1, 0], "death": [0, 1], "damage_taken": [0, 20]}


def test_outliving_the_others_pays_one_in_all() -> None:
    match = make_match("royale", seats=4, zone={"phases": ()})
    third = pytest.approx(1 / 3)
    match.state.agents.damage[0, 1] = 1000
    assert paid(match, "outlived")["outlived"] == [third, 0, third, third]
    match.state.agents.damage[0, 2:] = 1000
    # Both are second now, as each would be if the other had not gone out with it.
    assert paid(match, "outlived")["outlived"] == [pytest.approx(2 / 3), 0, third, third]


def test_terms_are_weighted() -> None:
    before, after = np.zeros((2, FACTS), np.float32), np.ones((2, FACTS), np.float32)
    assert paid_between(before, after, kill=2.0, step=-0.5) == {"kill": [2.0, 2.0], "step": [-0.5, -0.5]}


@pytest.mark.parametrize(
    ("weights", "message"), [({"kills": 1}, "no reward term 'kills'"), ({"kill": np.nan}, "finite")]
)
def test_terms_that_do_not_exist_are_refused(weights: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        RewardSum(weights)


@pytest.mark.parametrize("name", TRACKS)
def test_every_track_pays_by_terms_that_exist(name: str) -> None:
    assert set(TRACKS[name].rewards) <= set(REWARD_TERMS)
