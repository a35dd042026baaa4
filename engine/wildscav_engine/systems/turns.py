"""Whose turn comes first: a random seat and a random direction in every frame.

Of any two seats, each comes before the other in half of all frames, so no seat has an advantage.
"""

from typing import NamedTuple

from wildscav_engine.kernel import kernel
from wildscav_engine.rng import Stream, Word, integer_in, uniform


class Turns(NamedTuple):
    """The order of the seats in one frame."""

    first: int
    direction: int  # 1 or -1
    seats: int


@kernel
def draw_turns(seed: Word, frame: int, seats: int) -> Turns:
    """Return the order of a frame."""
    first = integer_in(0, seats - 1, seed, Stream.TURNS, frame, 0, 0)
    direction = 1 if uniform(seed, Stream.TURNS, frame, 0, 1) < 0.5 else -1
    return Turns(first, direction, seats)


@kernel
def seat_at(turns: Turns, turn: int) -> int:
    """Return whose turn it is, 0 being the first."""
    return (turns.first + turns.direction * turn) % turns.seats
