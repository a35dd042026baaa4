"""The order of the seats in a frame: fair among any of them."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2
from tests.builders import act, flat_world, lay_boxes, make_match, place, position

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.turn_order import draw_turns

FRAMES = 24_000
ROUNDS = 900
# Neighbours in a cycle of ten seats: taking turns in such a cycle is unfair to the middle one.
GROUP = (9, 0, 1)


@kernel
def _draw_many(seed: int, orders: NDArray[np.int32]) -> None:
    for frame in range(orders.shape[0]):
        draw_turns(seed, frame, orders[frame])


def orders(seats: int, frames: int = FRAMES, seed: int = 5) -> NDArray[np.int32]:
    """(frames, seats) the orders of so many frames."""
    drawn = np.full((frames, seats), -1, np.int32)
    _draw_many(np.uint64(seed), drawn)
    return drawn


@pytest.mark.parametrize("seats", [1, 2, 3, 5, 64])
def test_every_seat_has_one_turn_in_each_frame(seats: int) -> None:
    assert (np.sort(orders(seats, 100), axis=1) == np.arange(seats)).all()


def test_all_orders_are_equally_likely() -> None:
    counts = dict.fromkeys(itertools.permutations(range(4)), 0)
    for order in orders(4).tolist():
        counts[tuple(order)] += 1
    expected = FRAMES / 24
    # Chi squared with 23 degrees of freedom is above 50 once in a thousand; the draws are always the same.
    assert sum((count - expected) ** 2 / expected for count in counts.values()) < 50


def is_even(counts: ArrayLike, error_rate: float) -> bool:
    """Return whether counts differ by no more than chance; fair ones are called uneven at the error rate."""
    seen = np.asarray(counts, np.float64)
    expected = seen.sum() / len(seen)
    return bool(((seen - expected) ** 2 / expected).sum() < chi2.isf(error_rate, len(seen) - 1))


def test_of_any_group_of_ten_seats_each_comes_first_equally_often() -> None:
    # 1013 groups: fair orders would fail once in a thousand seeds. The seed is always the same.
    turn_of = np.argsort(orders(10), axis=1, kind="stable")
    for size in range(2, 11):
        for group in itertools.combinations(range(10), size):
            firsts = np.bincount(turn_of[:, group].argmin(axis=1), minlength=size)
            assert is_even(firsts, error_rate=1e-6), (group, firsts)


def test_frames_and_matches_have_orders_of_their_own() -> None:
    assert len({tuple(order) for order in orders(30, 500).tolist()}) == 500
    assert (orders(30, 50, seed=5) != orders(30, 50, seed=6)).any(axis=1).all()


def try_to_get_a_box(match: Match, frame: int) -> int:
    for seat, x in zip(GROUP, (-1.0, 0.0, 1.0), strict=True):
        place(match, seat, (x, 0, 0))
    lay_boxes(match, (0, 0, 0), quantity=1, serial=frame)
    before = match.state.agents.supplies[0].copy()
    act(match, 1, **{f"seat_{seat}": {"pick_up": 1} for seat in GROUP})
    return int((match.state.agents.supplies[0] - before).argmax())


def try_to_kill(match: Match, _: int) -> int:
    agents = match.state.agents
    agents.health[0, 5], agents.respawn_left[0, 5], agents.invincible_left[0, 5] = 20, 0, 0
    place(match, 5, (0, 0, 0))
    for seat, side in zip(GROUP, (0.0, 90.0, 180.0), strict=True):
        place(match, seat, (-5 * np.sin(np.radians(side)), 0, -5 * np.cos(np.radians(side))), yaw=side)
        agents.clip[0, seat], agents.fire_left[0, seat] = 10, 0
    before = agents.kills[0].copy()
    act(match, 1, **{f"seat_{seat}": {"shoot": 1} for seat in GROUP})
    return int((agents.kills[0] - before).argmax())


def try_to_get_to_the_middle(match: Match, _: int) -> int:
    # Three bodies with a radius of 0.45 m, 0.97 m apart: whoever moves first gets farthest.
    sides = dict(zip(GROUP, (0.0, 120.0, 240.0), strict=True))
    for seat, side in sides.items():
        place(match, seat, (0.56 * np.sin(np.radians(side)), 0, 0.56 * np.cos(np.radians(side))))
    walks = {seat: {"walk_direction": side + 180.0, "walk_speed": 10} for seat, side in sides.items()}
    act(match, 1, **{f"seat_{seat}": walk for seat, walk in walks.items()})
    return min(sides, key=lambda seat: float(np.hypot(position(match, seat)[0], position(match, seat)[2])))


def try_to_drop_the_last_box(match: Match, frame: int) -> int:
    supplies, agents = match.state.supplies, match.state.agents
    slots = supplies.quantity.shape[1]
    lay_boxes(match, *[(15.0, 0, 15.0)] * (slots - 1), quantity=1, serial=frame)
    for seat, x in zip(GROUP, (-1.0, 0.0, 1.0), strict=True):
        place(match, seat, (x, 0, 0))
        agents.health[0, seat], agents.respawn_left[0, seat], agents.invincible_left[0, seat] = 20, 0, 0
        agents.supplies[0, seat], agents.damage[0, seat] = 10, 20
    act(match, 1)
    return int(min(GROUP, key=lambda seat: agents.supplies[0, seat]))


@pytest.mark.parametrize(
    "attempt", [try_to_get_a_box, try_to_kill, try_to_get_to_the_middle, try_to_drop_the_last_box]
)
def test_of_three_neighbours_that_want_the_same_each_gets_it_equally_often(
    attempt: Callable[[Match, int], int],
) -> None:
    match = make_match("battle", world=flat_world(), seats=10, frames_per_action=1, time_limit=600)
    for seat in range(10):
        place(match, seat, (2.0 * seat - 9.0, 0, 12))
    got = [attempt(match, frame) for frame in range(ROUNDS)]
    # Fair orders would fail once in a thousand seeds. The seed is always the same.
    assert is_even([got.count(seat) for seat in GROUP], error_rate=1e-3), attempt.__name__
    assert set(got) == set(GROUP)
