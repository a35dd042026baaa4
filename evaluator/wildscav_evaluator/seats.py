"""The seats of a match: their order, their submissions, and their display names."""

from collections.abc import Collection, Sequence

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.specs.match_spec import SUBMISSION

BATTLE_ROBOTS = ("fighter", "gatherer")
ROBOT_ENTRANT = "robot:"  # before the name of a robot that is an entrant of a tournament


def battle_seats(dice: RandomStream, robots: int) -> tuple[str, ...]:
    """Return the seats of a battle of one submission against robots, mixed and placed at random.

    Every kind of robot occurs as often as the others, give or take one. The submission's seat is random too,
    so that no agent can rely on its seat.
    """
    seats = [BATTLE_ROBOTS[number % len(BATTLE_ROBOTS)] for number in range(robots)]
    return shuffled(dice, (*seats, SUBMISSION))


def shuffled(dice: RandomStream, seats: Sequence[str]) -> tuple[str, ...]:
    """Return seats in random order, with all orders equally likely."""
    order = list(seats)
    for last in range(len(order) - 1, 0, -1):
        other = dice.integer(0, last)
        order[last], order[other] = order[other], order[last]
    return tuple(order)


def submission_seats(seats: Sequence[str]) -> tuple[int, ...]:
    """Return the seats that agent processes fill."""
    return tuple(seat for seat, filled_by in enumerate(seats) if filled_by == SUBMISSION)


def robot_entrant(robot: str) -> str:
    """Return the name of a robot that is an entrant of a tournament; no submission has such a name."""
    return f"{ROBOT_ENTRANT}{robot}"


def entrants_of_seats(
    seats: Sequence[str], submissions: Sequence[str], robots: Collection[int] = ()
) -> dict[int, str]:
    """Return the name of the entrant in each seat that has one, in the order of the seats.

    ``robots`` are the seats of robots that are entrants.
    """
    waiting = iter(submissions)
    return {
        seat: next(waiting) if filled_by == SUBMISSION else robot_entrant(filled_by)
        for seat, filled_by in enumerate(seats)
        if filled_by == SUBMISSION or seat in robots
    }


def display_names(
    seats: Sequence[str], submissions: Sequence[str], robots: Collection[int] = ()
) -> tuple[str, ...]:
    """Return a name for every seat: the entrants' names, and those of other robots with a number.

    An entrant in several seats is numbered too, after a space. For the arguments see ``entrants_of_seats``.
    """
    entrants = entrants_of_seats(seats, submissions, robots)
    plain = [entrants.get(seat, filled_by) for seat, filled_by in enumerate(seats)]
    names, counts = [], dict.fromkeys(plain, 0)
    for seat, name in enumerate(plain):
        counts[name] += 1
        alone = seat in entrants and plain.count(name) == 1
        names.append(name if alone else f"{name} {counts[name]}")
    return tuple(names)


def entrants_in_names(seats: Sequence[str], names: Sequence[str]) -> dict[int, str]:
    """Return the entrants of a match by their seats, given the display names of all seats."""
    return {
        seat: name.partition(" ")[0]
        for seat, (filled_by, name) in enumerate(zip(seats, names, strict=True))
        if filled_by == SUBMISSION or name.startswith(ROBOT_ENTRANT)
    }
