"""Stairs: a hall with a stairwell at the same place on every storey, so that flights are above each other.

There are two kinds. In a *straight* hall one flight runs along a wall, with a passage beside it that leads
back to the next flight. In a *turning* hall two flights meet on a landing halfway up.
"""

from typing import NamedTuple

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import (
    INNER_WALL,
    NARROWEST_ROOM,
    PASSAGE_WIDTH,
    Flight,
    Side,
    Stairs,
    part_of,
    span_of,
)

RISE, GOING = 0.2, 0.28  # m, of a step
RISES = 15  # from floor to floor
LANDING_HEIGHT = 8 * RISE  # m above the floor below, halfway up turning stairs
FLIGHT_WIDTH = PASSAGE_WIDTH  # m, width of a flight
SPINE = 0.15  # m, thickness of the wall between flights
ENTRY = 1.95  # m of free space in front of the first step, wide enough for doorways on either side
EDGE = 0.15  # m, thickness of railings and of the walls of the stair house
HALL_WIDTH = 2.0 * FLIGHT_WIDTH + SPINE
STRAIGHT_RUN = (RISES - 1) * GOING
TURNING_RUN = 7 * GOING
STRAIGHT_HALL = ENTRY + STRAIGHT_RUN + PASSAGE_WIDTH + EDGE
TURNING_HALL = ENTRY + TURNING_RUN + FLIGHT_WIDTH


class _HallAxes(NamedTuple):
    """The axes of a hall: u from one of its long sides, v from its entry to its far end."""

    hall: Rectangle
    entry: Side
    mirrored: bool

    def place(self, u_0: float, v_0: float, u_1: float, v_1: float) -> Rectangle:
        """Return a rectangle given in these axes in the axes of the house."""
        left, back, right, front = self.hall
        width, length = right - left, front - back
        if not self.entry.is_across:
            width, length = length, width
        if self.mirrored:
            u_0, u_1 = width - u_1, width - u_0
        if self.entry.is_ahead:
            v_0, v_1 = length - v_1, length - v_0
        if self.entry.is_across:
            return Rectangle(left + u_0, back + v_0, left + u_1, back + v_1)
        return Rectangle(left + v_0, back + u_0, left + v_1, back + u_1)


class HallPlace(NamedTuple):
    """A hall with stairs in a block, and the rest of the block."""

    stairs: Stairs
    rest: tuple[Rectangle, ...]
    walls: tuple[tuple[Rectangle, bool], ...]  # the walls between them: outline, and whether it runs across


def draw_stairs(dice: RandomStream, inside: Rectangle) -> HallPlace:
    """Cut a hall with stairs, all the way through, out of a block that is at least 6.5 m wide inside."""
    runs_along = dice.uniform() < 0.7
    low, high = (inside.left, inside.right) if runs_along else (inside.back, inside.front)
    strip = _draw_strip(dice, low, high)
    start, end = (inside.back, inside.front) if runs_along else (inside.left, inside.right)
    entry_ahead = dice.uniform() < (0.75 if runs_along else 0.5)
    straight = end - start >= STRAIGHT_HALL and dice.uniform() < 0.5
    spare = end - start - (STRAIGHT_HALL if straight else TURNING_HALL) - INNER_WALL
    # A room behind the stairs or in front of the hall, if there is space for one.
    behind = spare if spare >= NARROWEST_ROOM and dice.uniform() < 0.8 else 0.0
    if behind > NARROWEST_ROOM:
        behind = dice.uniform(max(NARROWEST_ROOM, behind - 2.0), behind)
    at_end = entry_ahead if dice.uniform() < 0.2 else not entry_ahead
    hall_start, hall_end = start, end
    cut = None
    if behind:
        cut = end - behind - INNER_WALL if at_end else start + behind
        hall_start, hall_end = (start, cut) if at_end else (cut + INNER_WALL, end)
    ahead = Side.FRONT if runs_along else Side.RIGHT
    entry = ahead if entry_ahead else ahead.opposite
    rest, walls = _around(inside, runs_along, strip, cut, at_end)
    hall = _oriented(runs_along, strip[0], hall_start, strip[1], hall_end)
    axes = _HallAxes(hall, entry, dice.uniform() < 0.5)
    length = hall_end - hall_start
    stairs = _straight(axes, length) if straight else _turning(axes, length)
    return HallPlace(stairs, tuple(rest), tuple(walls))


def _oriented(runs_along: bool, u_0: float, v_0: float, u_1: float, v_1: float) -> Rectangle:
    return Rectangle(u_0, v_0, u_1, v_1) if runs_along else Rectangle(v_0, u_0, v_1, u_1)


def _draw_strip(dice: RandomStream, low: float, high: float) -> tuple[float, float]:
    """Draw the position of the hall between two walls: at one of them, or with rooms on both sides."""
    needed = NARROWEST_ROOM + INNER_WALL
    slack = high - low - HALL_WIDTH
    choice = dice.uniform()
    if slack >= 2.0 * needed and choice < 0.6:
        offset = dice.uniform(needed, slack - needed)
        return low + offset, low + offset + HALL_WIDTH
    return (low, low + HALL_WIDTH) if dice.uniform() < 0.5 else (high - HALL_WIDTH, high)


def _around(
    inside: Rectangle, runs_along: bool, strip: tuple[float, float], cut: float | None, at_end: bool
) -> tuple[list[Rectangle], list[tuple[Rectangle, bool]]]:
    """Return the blocks beside a strip and behind its hall, and the walls between."""
    low, high = (inside.left, inside.right) if runs_along else (inside.back, inside.front)
    start, end = (inside.back, inside.front) if runs_along else (inside.left, inside.right)
    rest, walls = [], []
    if strip[0] > low:
        edge = strip[0] - INNER_WALL
        rest.append(_oriented(runs_along, low, start, edge, end))
        walls.append((_oriented(runs_along, edge, start, strip[0], end), not runs_along))
    if strip[1] < high:
        edge = strip[1] + INNER_WALL
        rest.append(_oriented(runs_along, edge, start, high, end))
        walls.append((_oriented(runs_along, strip[1], start, edge, end), not runs_along))
    if cut is not None:
        behind = (cut + INNER_WALL, end) if at_end else (start, cut)
        rest.append(_oriented(runs_along, strip[0], behind[0], strip[1], behind[1]))
        walls.append((_oriented(runs_along, strip[0], cut, strip[1], cut + INNER_WALL), runs_along))
    return rest, walls


def _straight(axes: _HallAxes, length: float) -> Stairs:
    """Return stairs of one flight on one side, which ends at least PASSAGE_WIDTH before the far end."""
    first = max(ENTRY, 0.5 * (length - STRAIGHT_RUN))
    last = first + STRAIGHT_RUN
    flight = Flight(axes.place(0.0, first, FLIGHT_WIDTH, last), axes.entry.opposite, 0)
    return Stairs(
        hall=axes.hall,
        well=flight.outline,
        flights=(flight,),
        landing=None,
        spine=axes.place(FLIGHT_WIDTH, first - EDGE, FLIGHT_WIDTH + SPINE, last),
        foot=axes.place(0.0, first - EDGE, FLIGHT_WIDTH, first),
        exit=axes.place(0.0, last, FLIGHT_WIDTH, last + EDGE),
        entry=axes.entry,
    )


def _turning(axes: _HallAxes, length: float) -> Stairs:
    """Return stairs of two flights that turn on a landing at the far end."""
    turn = length - FLIGHT_WIDTH
    first = turn - TURNING_RUN
    upper = FLIGHT_WIDTH + SPINE
    up = Flight(axes.place(0.0, first, FLIGHT_WIDTH, turn), axes.entry.opposite, 0)
    back = Flight(axes.place(upper, first, HALL_WIDTH, turn), axes.entry, 8)
    return Stairs(
        hall=axes.hall,
        well=axes.place(0.0, first, HALL_WIDTH, length),
        flights=(up, back),
        landing=axes.place(0.0, turn, HALL_WIDTH, length),
        spine=axes.place(FLIGHT_WIDTH, first, upper, turn),
        foot=axes.place(0.0, first - EDGE, upper, first),
        exit=axes.place(upper, first - EDGE, HALL_WIDTH, first),
        entry=axes.entry,
    )


def steps_of(flight: Flight) -> list[tuple[Rectangle, float]]:
    """Return the steps of a flight: the area of each, and its height in m above the floor below."""
    low, high = span_of(flight.outline, flight.climbs.aside)
    steps = []
    for step in range(round((high - low) / GOING)):
        near = step * GOING
        is_ahead = flight.climbs.is_ahead
        span = (low + near, low + near + GOING) if is_ahead else (high - near - GOING, high - near)
        steps.append((part_of(flight.outline, flight.climbs.aside, *span), (flight.first + step + 1) * RISE))
    return steps
