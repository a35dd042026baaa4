"""The order of the seats in a frame: fair among any of them."""

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import act, flat_world, lay_boxes, make_match, place

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.systems.turn_order import draw_turns

FRAMES = 24_000


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


@pytest.mark.parametrize("some", [(9, 0, 1), (0, 1, 2), (2, 5, 8), (0, 9), (1, 3, 5, 7, 9)])
def test_any_of_ten_seats_come_first_equally_often(some: tuple[int, ...]) -> None:
    turn_of = np.argsort(orders(10), axis=1, kind="stable")[:, list(some)]
    firsts = np.bincount(turn_of.argmin(axis=1), minlength=len(some))
    assert firsts == pytest.approx([FRAMES / len(some)] * len(some), rel=0.05)


def test_frames_and_matches_have_orders_of_their_own() -> None:
    assert len({tuple(order) for order in orders(30, 500).tolist()}) == 500
    assert (orders(30, 50, seed=5) != orders(30, 50, seed=6)).any(axis=1).all()


def test_three_neighbours_get_a_box_equally_often() -> None:
    match = make_match("gathering", world=flat_world(), seats=10, frames_per_action=1, time_limit=600)
    for seat in range(10):
        place(match, seat, (2.0 * seat - 9.0, 0, 12))
    for seat, x in ((9, -1.0), (0, 0.0), (1, 1.0)):
        place(match, seat, (x, 0, 0))
    for frame in range(1200):
        lay_boxes(match, (0, 0, 0), quantity=1, serial=frame)
        act(match, 1, **{f"seat_{seat}": {"pick_up": 1} for seat in (9, 0, 1)})
    got = match.state.agents.supplies[0, [9, 0, 1]]
    assert got.sum() == 1200
    assert got.min() > 340
