"""Rounds that are known to be balanced: the circle method for games of two, and lattices for larger ones."""

from math import gcd

import numpy as np
from numpy.typing import NDArray

Int = NDArray[np.int64]


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
