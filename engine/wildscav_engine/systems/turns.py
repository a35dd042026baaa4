"""Whose turn comes first: a random seat and a random direction in every frame.

Of any two seats, each comes before the other in half of all frames, so no seat has an advantage.
"""

from typing import NamedTuple

from wildscav_engine.kernel import inlined_kernel
from wildscav_engine.rng import Stream, Word, philox, to_unit


class Turns(NamedTuple):
    """The order of the seats in one frame."""

    first: int
    direction: int  # 1 or -1
    seats: int


@inlined_kernel
def draw_turns(seed: Word, frame: int, seats: int) -> Turns:
    """Return the order of a frame."""
    if seats == 1:
        return Turns(0, 1, 1)
    place, way = philox(seed, Stream.TURNS, frame, 0, 0)
    first = min(seats - 1, int(to_unit(place) * seats))
    return Turns(first, 1 if to_unit(way) < 0.5 else -1, seats)


@inlined_kernel
def seat_at(turns: Turns, turn: int) -> int:
    """Return whose turn it is, 0 being the first."""
    seat = turns.first + turns.direction * turn
    if seat < 0:
        return seat + turns.seats
    return seat if seat < turns.seats else seat - turns.seats
