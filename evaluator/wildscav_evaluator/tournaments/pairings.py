"""Who plays in which game: rounds in which everyone plays, and all pairs meet, equally often.

A round has n / g games of P places, with g the greatest common divisor of the entrants n and P, so that
everyone plays P / g of them. It is the least number of games in which everyone can play equally often.

Without groups, the games depend on the numbers of entrants, places and rounds alone; a schedule's seed then
decides which entrant is which. So whether a tournament of given size is balanced does not depend on its seed.
"""

from collections.abc import Iterator
from functools import lru_cache
from math import gcd

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.constructions import (
    balanced_after,
    complement,
    lattice,
    lattice_rounds,
    round_robin,
)
from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import count_meetings, spread_of
from wildscav_evaluator.tournaments.shift_search import search_shifts
from wildscav_evaluator.tournaments.swap_search import search_swaps

Int = NDArray[np.int64]

SHIFT_WORK = 20_000_000  # numbers read from memory: about a fifth of a second
SWAP_WORK = 8_000_000  # swaps looked at: about a fifth of a second
SWAP_STEPS = 1000  # at most
MANY_ENTRANTS = 200  # among more, a search by shifts comes nearer than one by swaps
MANY_CELLS = 4_000_000  # places of base games times places: what is searched at once


def round_games(entrants: int, places: int) -> int:
    """Return the number of games in a round."""
    return entrants // gcd(entrants, places)


@lru_cache(maxsize=64)
def pair_up(entrants: int, places: int, rounds: int) -> Int:
    """Return the games (R, B, P) of rounds in which any two entrants may meet, as a read-only array."""
    games = _best(_attempts(entrants, places, rounds), entrants)
    games.setflags(write=False)
    return games


@lru_cache(maxsize=64)
def pair_up_groups(groups: tuple[int, ...], places: int, rounds: int) -> Int:
    """Return the games (R, B, P) of rounds in which entrants of one group never meet, as a read-only array.

    Args:
        groups: (n,) the group of each entrant, numbered from 0; none has more than n / P entrants.
        places: P.
        rounds: R.
    """
    games = _swapped(np.asarray(groups), places, rounds, Draws("groups", groups, places, rounds))
    games.setflags(write=False)
    return games


def _best(attempts: Iterator[Int], entrants: int) -> Int:
    """Return the first games whose meetings differ by one at most, or else the most even ones."""
    best, best_rank = None, (0, 0)
    for games in attempts:
        meetings = count_meetings(games, entrants)
        rank = (spread_of(meetings, range(entrants)), int((meetings * meetings).sum()))
        if best is None or rank < best_rank:
            best, best_rank = games, rank
        if best_rank[0] <= 1:
            break
    if best is None:
        raise ValueError("there are no games to choose from")
    return best


def _attempts(entrants: int, places: int, rounds: int) -> Iterator[Int]:
    """Make games in several ways; those that are certain to be balanced come first."""
    if places == entrants:
        yield np.broadcast_to(np.arange(entrants), (rounds, 1, entrants)).copy()
    elif places == 1:
        yield np.broadcast_to(np.arange(entrants)[:, None], (rounds, entrants, 1)).copy()
    elif places == 2:
        yield round_robin(entrants, rounds)
    elif 2 * places > entrants:
        yield complement(pair_up(entrants, entrants - places, rounds), entrants)
    elif rounds * places * places > MANY_CELLS:
        yield _in_parts(entrants, places, rounds, max(1, MANY_CELLS // (places * places)))
    else:
        yield from _constructed(entrants, places, rounds)
        yield from _searched(entrants, places, rounds)


def _in_parts(entrants: int, places: int, rounds: int, most: int) -> Int:
    """Return rounds that are made in parts of at most so many, each with the entrants in another order."""
    draws = Draws("parts", entrants, places, rounds)
    parts = [
        draws.order(entrants)[pair_up(entrants, places, min(most, rounds - start))]
        for start in range(0, rounds, most)
    ]
    return np.concatenate(parts)


def _constructed(entrants: int, places: int, rounds: int) -> Iterator[Int]:
    """Make games from lattices, and from cycles after which everyone has met everyone else equally often."""
    if rounds <= lattice_rounds(entrants, places):
        yield lattice(entrants, places, rounds)
    shortest = balanced_after(entrants, places)
    cycles = (cycle for cycle in range(shortest, rounds, shortest) if _may_balance(entrants, places, cycle))
    cycle = next(cycles, None)
    if cycle is not None:
        whole = pair_up(entrants, places, cycle)
        if spread_of(count_meetings(whole, entrants), range(entrants)) == 0:
            rest = [pair_up(entrants, places, rounds % cycle)] if rounds % cycle else []
            yield np.concatenate([whole] * (rounds // cycle) + rest)


def _may_balance(entrants: int, places: int, rounds: int) -> bool:
    """Return whether no known theorem forbids that all pairs have met equally often after so many rounds.

    There must be at least n games (R. A. Fisher, 1940), and n + R - 1 if everyone plays once in a round
    (R. C. Bose, 1942).
    """
    games = rounds * round_games(entrants, places)
    return games >= (entrants + rounds - 1 if entrants % places == 0 else entrants)


def _searched(entrants: int, places: int, rounds: int) -> Iterator[Int]:
    draws = Draws("rounds", entrants, places, rounds)
    # If P divides n, entrants of one circle never meet, which is as it should be in few rounds only.
    if entrants % places or rounds * (places - 1) < entrants:
        yield search_shifts(entrants, places, rounds, SHIFT_WORK, draws)
        if entrants > MANY_ENTRANTS:
            return
    yield _swapped(np.arange(entrants), places, rounds, draws)


def _swapped(group: Int, places: int, rounds: int, draws: Draws) -> Int:
    """Return the games (R, B, P) that a search by swaps finds."""
    games = round_games(len(group), places)
    attempts = max(1, min(32, 10_000 // (games * places * places), 200_000 // len(group) ** 2))
    width = max(1, min(rounds // 4, 5_000 // (games * places * places)))
    steps = min(SWAP_STEPS, SWAP_WORK // (attempts * width * games * places * places))
    start = _deal(group, places, (attempts, rounds), draws)
    return search_swaps(start, group[:, None] == group[None, :], steps, draws, width)


def _deal(group: Int, places: int, shape: tuple[int, int], draws: Draws) -> Int:
    """Return the games (B, P) of as many rounds as the shape says, in which no two entrants of a group meet.

    The entrants stand in a row group by group, each as often as it plays in a round. The games take turns
    along the row. A group of at most n / P entrants has at most as many places in the row as there are games,
    so no game comes to it twice.
    """
    entrants, games = len(group), round_games(len(group), places)
    order = draws.orders(*shape, entrants)
    rank = draws.orders(*shape, int(group.max()) + 1)
    by_group = np.argsort(np.take_along_axis(rank, group[order], axis=-1), axis=-1, kind="stable")
    row = np.repeat(np.take_along_axis(order, by_group, axis=-1), games * places // entrants, axis=-1)
    dealt: Int = row.reshape(*shape, places, games).swapaxes(-1, -2).copy()
    return dealt
