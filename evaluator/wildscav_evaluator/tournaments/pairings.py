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


def lattice_rounds(entrants: int, places: int) -> int:
    """Return how many rounds `lattice` can make; 0 if it does not fit the numbers.

    It fits n = P q entrants with q a power of a prime and q >= P.
    """
    if entrants % places or places < 2:
        return 0
    size = entrants // places
    if size == 1:
        return 1
    if size < places or _prime_power(size) is None:
        return 0
    return size + lattice_rounds(size, places)


def lattice(entrants: int, places: int, rounds: int) -> Int:
    """Return rounds (R, n / P, P) in which no pair meets twice; R is at most `lattice_rounds`.

    Entrants are P classes of q, named by the elements of the finite field of q elements (R. C. Bose, "On the
    application of the properties of Galois fields to the problem of construction of hyper-Graeco-Latin
    squares", 1938). In round t, game b has the entrant b + t i of class i. After q rounds everyone has met
    all of the other classes once, and the classes play among themselves, again as lattices if they can.
    """
    size = entrants // places
    if size == 1:
        return np.arange(entrants).reshape(1, 1, entrants)[:rounds]
    plus, times = _field(size)
    game, chosen = np.arange(size)[:, None], np.arange(places)
    played = [plus[game, times[number, chosen]] + size * chosen for number in range(min(rounds, size))]
    games = np.stack(played)
    if rounds <= size:
        return games
    within = lattice(size, places, rounds - size)  # (R', q / P, P)
    classes = size * np.arange(places)[None, :, None, None]
    return np.concatenate([games, (within[:, None] + classes).reshape(len(within), -1, places)])


def complement(games: Int, entrants: int) -> Int:
    """Return the games (R, B, n - P) of those who do not play in the games (R, B, P)."""
    rounds, count, _ = games.shape
    absent = np.ones((rounds, count, entrants), bool)
    np.put_along_axis(absent, games, False, axis=2)
    return np.nonzero(absent)[2].reshape(rounds, count, -1)


def balanced_after(entrants: int, places: int) -> int:
    """Return the least number of rounds in which everyone could have met everyone else equally often."""
    meetings = places // gcd(entrants, places) * (places - 1)  # of an entrant in a round
    return (entrants - 1) // gcd(entrants - 1, meetings)


def _prime_power(number: int) -> tuple[int, int] | None:
    """Return the prime and the exponent of a power of a prime, and None for other numbers."""
    prime = next(factor for factor in range(2, number + 1) if number % factor == 0)
    exponent = 0
    while number % prime == 0:
        number, exponent = number // prime, exponent + 1
    return (prime, exponent) if number == 1 else None


def _field(size: int) -> tuple[Int, Int]:
    """Return the tables (q, q) of sums and products of the finite field of q elements, q a power of a prime.

    An element is a polynomial; its number has the coefficients as digits to the base of the prime.
    """
    power = _prime_power(size)
    if power is None:
        raise ValueError(f"{size} is not a power of a prime")
    prime, exponent = power
    weights = prime ** np.arange(exponent)
    digits = np.arange(size)[:, None] // weights % prime
    plus = ((digits[:, None] + digits[None, :]) % prime) @ weights
    powers = _powers(prime, exponent)
    logarithms = np.zeros(size, np.int64)
    logarithms[powers] = np.arange(size - 1)
    times = powers[(logarithms[:, None] + logarithms[None, :]) % (size - 1)]
    times[0], times[:, 0] = 0, 0
    return plus, times


def _powers(prime: int, exponent: int) -> Int:
    """Return the powers (q - 1,) of an element that reaches all elements but 0."""
    size = prime**exponent
    if exponent == 1:
        for base in range(1, prime):
            powers = [1]
            while (following := powers[-1] * base % prime) != 1:
                powers.append(following)
            if len(powers) == size - 1:
                return np.array(powers)
    # x itself, modulo x^k + the polynomial `rest`, for the first such polynomial that works.
    top = size // prime
    for rest in range(1, size):
        digits = [rest // prime**place % prime for place in range(exponent)]
        powers = [1]
        while len(powers) < size:
            carry, shifted = powers[-1] // top, powers[-1] % top * prime
            following = sum(
                ((shifted // prime**place - carry * digit) % prime) * prime**place
                for place, digit in enumerate(digits)
            )
            if following in (0, 1):
                break
            powers.append(following)
        if len(powers) == size - 1:
            return np.array(powers)
    raise ArithmeticError(f"no primitive polynomial of degree {exponent} modulo {prime}")
