"""The seats of a match: their order, their submissions, and their display names."""

from collections.abc import Sequence

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.specs.match_spec import SUBMISSION

BATTLE_ROBOTS = ("fighter", "gatherer")


def battle_seats(dice: Dice, robots: int) -> tuple[str, ...]:
    """Return the seats of a battle of one submission against robots, mixed and placed at random.

    Every kind of robot occurs as often as the others, give or take one. The submission's seat is random too,
    so that no agent can rely on its seat.
    """
    seats = [BATTLE_ROBOTS[number % len(BATTLE_ROBOTS)] for number in range(robots)]
    return shuffled(dice, (*seats, SUBMISSION))


def shuffled(dice: Dice, seats: Sequence[str]) -> tuple[str, ...]:
    """Return seats in random order, with all orders equally likely."""
    order = list(seats)
    for last in range(len(order) - 1, 0, -1):
        other = dice.integer(0, last)
        order[last], order[other] = order[other], order[last]
    return tuple(order)


def submission_seats(seats: Sequence[str]) -> tuple[int, ...]:
    """Return the seats that agent processes fill."""
    return tuple(seat for seat, filled_by in enumerate(seats) if filled_by == SUBMISSION)


def display_names(seats: Sequence[str], submissions: Sequence[str]) -> tuple[str, ...]:
    """Return a name for every seat: the submissions' in the order of their seats, the robots' with a number.

    A submission in several seats is numbered too.
    """
    waiting = iter(submissions)
    plain = [next(waiting) if filled_by == SUBMISSION else filled_by for filled_by in seats]
    names, counts = [], dict.fromkeys(plain, 0)
    for name, filled_by in zip(plain, seats, strict=True):
        counts[name] += 1
        alone = filled_by == SUBMISSION and plain.count(name) == 1
        names.append(name if alone else f"{name} {counts[name]}")
    return tuple(names)
