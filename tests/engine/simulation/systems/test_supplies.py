"""Rulings on supply boxes: who gets them, what the dead leave, and that none comes from nowhere."""

from typing import Any

import numpy as np
import pytest
from tests.builders import RICH, act, duel, flat_world, lay_boxes, make_match, place, seen_now

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.rules import Rules
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave


def gathering(seats: int = 1) -> Match:
    match = make_match("gathering", seats=seats, supplies=RICH)
    place(match, 0, (0, 0, 0))
    return match


@pytest.mark.parametrize(
    ("spot", "pick_up", "taken"),
    [
        ((0, 0, 0), 1, 3),
        ((1.49, 0, 0), 1, 3),
        ((1.51, 0, 0), 1, 0),
        ((0, 3, 0), 1, 0),  # on the next storey
        ((0, 0, 0), 0, 0),  # without the action nothing is picked up
    ],
)
def test_a_box_is_picked_up_within_a_metre_and_a_half(
    spot: tuple[float, float, float], pick_up: int, taken: int
) -> None:
    match = gathering()
    lay_boxes(match, spot)
    act(match, 1, seat_0={"pick_up": pick_up})
    assert match.state.agents.supplies[0, 0] == taken
    assert match.seen.can_pick_up[0, 0] == (not pick_up)


def test_a_frame_takes_one_box_the_nearest_first() -> None:
    match = make_match("gathering", supplies=RICH, frames_per_action=1)
    place(match, 0, (0, 0, 0))
    lay_boxes(match, (1, 0, 0), (0.5, 0, 0), (1.2, 0, 0))
    for left in ([3, 0, 3], [0, 0, 3], [0, 0, 0]):
        act(match, 1, seat_0={"pick_up": 1})
        assert match.state.supplies.quantity[0, :3].tolist() == left


def test_two_at_one_box_get_it_once() -> None:
    match = gathering(seats=2)
    place(match, 0, (0, 0, 0))
    place(match, 1, (1, 0, 0))
    lay_boxes(match, (0.5, 0, 0))
    act(match, 1, seat_0={"pick_up": 1}, seat_1={"pick_up": 1})
    assert match.state.agents.supplies[0].sum() == 3


@pytest.mark.parametrize(("one", "other"), [(0, 1), (3, 4), (9, 0), (2, 7)])
def test_no_seat_has_an_advantage_over_another(one: int, other: int) -> None:
    won = {one: 0, other: 0}
    match = make_match("gathering", seats=10, supplies=RICH, frames_per_action=1, time_limit=60)
    for seat in range(10):
        place(match, seat, (seat - 15, 0, 10))
    place(match, one, (0, 0, 0))
    place(match, other, (1, 0, 0))
    for _ in range(400):
        lay_boxes(match, (0.5, 0, 0))
        act(match, 1, **{f"seat_{seat}": {"pick_up": 1} for seat in won})
        for seat in won:
            won[seat] += int(match.state.agents.gained[0, seat] > 0)
    assert won[one] + won[other] == 400
    assert abs(won[one] - won[other]) < 80  # four standard deviations


REFRESHES = SupplyConfig(
    waves=tuple(
        SupplyWave(time=time, center=(5.0 * time, 0.0), radius=20.0, outdoor_richness=50.0)
        for time in (0.0, 1.0, 2.5)
    ),
    spacing=2.0,
)


def random_rows(random: np.random.Generator, seats: int) -> np.ndarray:
    """Everybody runs about, shoots and picks up."""
    rows = np.zeros((seats, 8), np.float32)
    rows[:, 0], rows[:, 1] = random.uniform(0, 360, seats), random.uniform(0, 10, seats)
    rows[:, 2] = random.uniform(-20, 20, seats)
    rows[:, 4:] = random.random((seats, 4)) < [0.1, 0.7, 0.9, 0.05]
    return rows


@pytest.mark.parametrize("seed", range(4))
def test_supplies_are_conserved_in_every_frame_of_a_battle(seed: int) -> None:
    random = np.random.default_rng(seed)
    loss = {"supply_loss": 0.3 + 0.2 * seed, "bounty": 20 * (seed % 2)}
    rules = Rules(shot_damage=100, respawn_time=0.5, invincible_time=0.1, **loss)  # type: ignore[arg-type]
    world = flat_world(60)
    timing: dict[str, Any] = {"frames_per_action": 1, "time_limit": 8}
    match = make_match(world=world, seats=12, seed=seed, supplies=REFRESHES, rules=rules, **timing)
    agents, supplies = match.state.agents, match.state.supplies
    total = int(supplies.quantity.sum())
    while not match.over:
        if match.frame % 25 == 0:  # else they would be too far from each other to meet often
            agents.position[0, :, ::2] = random.uniform(-8, 8, (12, 2))
        match.step(random_rows(random, 12))
        there = supplies.appears[0] <= match.frame
        on_ground, to_come = supplies.quantity[0, there].sum(), supplies.quantity[0, ~there].sum()
        assert on_ground + agents.supplies.sum() + to_come == total + rules.bounty * agents.kills.sum()
        assert supplies.quantity.min() >= 0
        if match.frame % 40 == 0:
            assert boxes_in_lists(match) == np.nonzero(supplies.quantity[0])[0].tolist()
    assert to_come == 0
    assert agents.deaths.sum() > 3
    dropped = supplies.serial[0] >= supplies.serial.shape[1] - 4 * 12
    assert dropped.any()


def boxes_in_lists(match: Match) -> list[int]:
    """All boxes that are found by their squares, in order."""
    found = []
    for head in match.state.matches.box_squares[0].tolist():
        slot = head - 1
        while slot >= 0:
            found.append(slot)
            slot = int(match.state.supplies.next_in_square[0, slot]) - 1
    return sorted(found)


def test_who_dies_where_no_slot_is_free_keeps_its_supplies() -> None:
    match = duel(supplies=RICH, rules=Rules(shot_damage=100))
    match.state.supplies.quantity[:] = 1
    match.state.agents.supplies[0, 1] = 10
    act(match, 1, seat_0={"shoot": 1})
    assert match.state.agents.deaths[0, 1] == 1
    assert match.state.agents.supplies[0, 1] == 10
    assert (match.state.supplies.quantity == 1).all()


@pytest.mark.parametrize(("share", "dropped"), [(0.0, 0), (0.5, 3), (1.0, 7)])
def test_a_share_is_dropped_rounded_down(share: float, dropped: int) -> None:
    match = duel(supplies=RICH, rules=Rules(shot_damage=100, supply_loss=share))
    lay_boxes(match)
    match.state.agents.supplies[0, 1] = 7
    act(match, 1, seat_0={"shoot": 1})
    assert match.state.supplies.quantity.sum() == dropped
    assert match.state.agents.supplies[0, 1] == 7 - dropped


def test_a_dropped_box_has_a_number_of_its_own_and_lies_in_a_slot_used_before() -> None:
    match = duel(supplies=RICH, rules=Rules(shot_damage=100, respawn_time=0.1, invincible_time=0))
    serials = set(match.state.supplies.serial[0, match.state.supplies.quantity[0] > 0].tolist())
    lay_boxes(match)
    for death in range(20):
        place(match, 1, (0.1 * death, 0, 10), yaw=180)
        match.state.agents.clip[0], match.state.agents.supplies[0, 1] = 15, 4
        aim = float(np.degrees(np.arctan2(0.1 * death, 10)))
        place(match, 0, (0, 0, 0), yaw=aim)
        act(match, 1, seat_0={"shoot": 1})
        act(match, 3)
    supplies = match.state.supplies
    dropped = supplies.serial[0, supplies.quantity[0] == 2].tolist()
    assert len(dropped) == len(set(dropped)) == match.state.agents.deaths[0, 1] == 20
    assert not serials & set(dropped)
    assert boxes_in_lists(match) == np.nonzero(supplies.quantity[0])[0].tolist()


@pytest.mark.parametrize("seed", range(3))
def test_the_boxes_found_are_those_of_a_look_at_all(seed: int) -> None:
    random = np.random.default_rng(seed)
    match = make_match("gathering", world=flat_world(200), supplies=RICH)
    count = match.state.supplies.quantity.shape[1]
    places = np.zeros((count, 3))
    places[:, ::2] = random.uniform(-60, 60, (count, 2)).round()  # some of them equally far away
    lay_boxes(match, *places)
    for _ in range(40):
        here = np.array([*random.uniform(-110, 110, 1), 0.0, *random.uniform(-110, 110, 1)])
        place(match, 0, here.tolist())
        seen = seen_now(match)
        distance = ((places - here) ** 2).sum(axis=1)
        near_first = np.lexsort((np.arange(count), distance))
        expected = near_first[distance[near_first] <= 400.0][:32].tolist()
        assert seen.supplies[0, 0, : seen.supply_count[0, 0]].tolist() == expected
        assert seen.can_pick_up[0, 0] == bool(distance.min() <= 2.25)
