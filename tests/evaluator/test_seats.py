"""Seats and the names that they are shown by."""

import pytest

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_evaluator.seats import battle_seats, display_names


def test_every_kind_of_robot_comes_up_as_often_give_or_take_one() -> None:
    seats = battle_seats(RandomStream(1, Stream.SUITE), robots=9)

    assert sorted(seats) == ["fighter"] * 5 + ["gatherer"] * 4 + ["submission"]


@pytest.mark.parametrize(
    ("seats", "submissions", "names"),
    [
        (("submission",), ["homing"], ("homing",)),
        (("fighter", "submission", "fighter"), ["homing"], ("fighter 1", "homing", "fighter 2")),
        (("submission", "submission"), ["homing", "hunter"], ("homing", "hunter")),
        (("submission", "submission"), ["homing", "homing"], ("homing 1", "homing 2")),
    ],
)
def test_display_names(seats: tuple[str, ...], submissions: list[str], names: tuple[str, ...]) -> None:
    assert display_names(seats, submissions) == names
