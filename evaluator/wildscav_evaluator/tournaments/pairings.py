"""Who plays in which game: rounds in which everyone plays equally often, and all pairs meet about so.

A round has n / g games of P places, with g the greatest common divisor of the entrants n and P, so that
everyone plays P / g of them. It is the least number of games in which everyone can play equally often.

The games depend on the sizes of the groups and on the numbers of places and rounds alone; a schedule's seed
then decides which entrant is which. So how balanced a tournament is does not depend on its seed.
"""

from functools import lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import even_out

Int = NDArray[np.int64]


def round_games(entrants: int, places: int) -> int:
    """Return the number of games in a round."""
    return entrants // gcd(entrants, places)


@lru_cache(maxsize=64)
def pair_up(groups: tuple[int, ...], places: int, rounds: int) -> Int:
    """Return the games (R, B, P) of rounds in which entrants of one group never meet, as a read-only array.

    If everyone may meet, the meetings of any two pairs differ by one at most in games of 2, n - 2 and more.
    Else entrants are dealt at random, and swapped between games until their meetings are about even.

    Args:
        groups: (n,) the group of each entrant, numbered from 0; none has more than n / P entrants.
        places: P.
        rounds: R.
    """
    entrants = len(groups)
    everyone_meets = len(set(groups)) == entrants
    if everyone_meets and places == 2:
        games = round_robin(entrants, rounds)
    elif everyone_meets and entrants > places > entrants / 2:
        games = complement(pair_up(groups, entrants - places, rounds), entrants)
    else:
        draws = Draws("games", groups, places, rounds)
        games = even_out(_deal(np.asarray(groups), places, rounds, draws), groups, draws)
    games.setflags(write=False)
    return games


def _deal(group: Int, places: int, rounds: int, draws: Draws) -> Int:
    """Return random games (R, B, P) in which no two entrants of a group meet.

    The entrants stand in a row group by group, each as often as it plays in a round. The games take turns
    along the row. A group of at most n / P entrants has at most as many places in the row as there are games,
    so no game comes to it twice.
    """
    entrants, games = len(group), round_games(len(group), places)
    order = draws.orders(rounds, entrants)
    rank = draws.orders(rounds, int(group.max()) + 1)
    by_group = np.argsort(np.take_along_axis(rank, group[order], axis=1), axis=1, kind="stable")
    row = np.repeat(np.take_along_axis(order, by_group, axis=1), games * places // entrants, axis=1)
    dealt: Int = row.reshape(rounds, places, games).swapaxes(1, 2).copy()
    return dealt


def round_robin(entrants: int, rounds: int) -> Int:
    """Return rounds (R, n / gcd(n, 2), 2) in which the meetings of any two pairs differ by one at most.

    The circle method: an even number of entrants meets in n - 1 rounds of n / 2 games, with one entrant in
    the middle of a circle of the others. An odd number meets in (n - 1) / 2 rounds of n games: in round d
    everyone plays the two who are d places away on the circle.
    """
    number = np.arange(rounds)[:, None]
    if entrants % 2:
        place = np.arange(entrants)[None, :]
        away = number % (entrants // 2) + 1
        return np.stack([np.broadcast_to(place, (rounds, entrants)), (place + away) % entrants], axis=2)
    circle = entrants - 1
    place = np.arange(entrants // 2)[None, :]
    first, second = (number + place) % circle, (number - place) % circle
    second[:, 0] = circle  # the one in the middle
    return np.stack([first, second], axis=2)


def complement(games: Int, entrants: int) -> Int:
    """Return the games (R, B, n - P) of those who do not play in the games (R, B, P)."""
    rounds, count, _ = games.shape
    absent = np.ones((rounds, count, entrants), bool)
    np.put_along_axis(absent, games, False, axis=2)
    return np.nonzero(absent)[2].reshape(rounds, count, -1)
