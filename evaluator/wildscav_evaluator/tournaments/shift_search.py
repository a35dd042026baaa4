"""Rounds that repeat one game all around a circle.

Let g be the greatest common divisor of the entrants n and the places P of a game. The entrants are g circles
of m = n / g. A round is one base game with P / g entrants of each circle, and its images when all circles
turn one place, two places … up to m - 1 places. So everyone plays P / g games in it. How often two entrants
meet depends only on their circles and on the distance between their places, so a search has n / m times fewer
unknowns than entrants. With g = 1 these are the cyclic designs of R. C. Bose (1939); with g = P two entrants
of one circle never meet.
"""

from math import gcd
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws

Int = NDArray[np.int64]

CHECKED_EVERY = 16  # steps
FORBIDDEN = 1 << 20  # counted meetings of an entrant with itself: more than a schedule has
OVERHEAD = 10_000  # what a step costs besides, in numbers read from memory
NOISE = 8  # sixteenths of a meeting, at the start


class Circles(NamedTuple):
    """Base games of C attempts that are searched at the same time."""

    shifts: Int  # (C, R, P) the place, on its circle, of each entrant of the base game of a round
    meetings: Int  # (C, g, g, m) how often entrants of two circles meet whose places differ by so much


def search_shifts(entrants: int, places: int, rounds: int, work: int, draws: Draws) -> Int:
    """Return the games (R, m, P) of rounds whose pairs meet about equally often.

    Args:
        entrants: n.
        places: P, at most n / 2.
        rounds: R.
        work: How many numbers may be read from memory. The search ends earlier once the meetings of any two
            pairs differ by one at most.
        draws: The source of randomness.
    """
    circles, size = gcd(entrants, places), entrants // gcd(entrants, places)
    attempts = max(1, min(16, 20_000 // (size * places), 1_000_000 // (rounds * places * places)))
    per_step = attempts * (size * places + (places // circles) ** 2) + OVERHEAD
    state = _start(attempts, rounds, places, circles, size, draws)
    steps = work // per_step
    for step in range(steps):
        if step % CHECKED_EVERY == 0 and _spreads(state.meetings).min() <= 1:
            break
        _turn_one(state, NOISE * (steps - step) // steps, draws)
    best = int(np.argmin(_spreads(state.meetings)))
    around = (state.shifts[best][:, None, :] + np.arange(size)[None, :, None]) % size
    games: Int = around + size * (np.arange(places) % circles)
    return games


def _start(attempts: int, rounds: int, places: int, circles: int, size: int, draws: Draws) -> Circles:
    """Return random base games in which nobody plays against itself."""
    shifts = draws.orders(attempts, rounds, circles, size)[..., : places // circles]
    shifts = np.ascontiguousarray(shifts.swapaxes(2, 3)).reshape(attempts, rounds, places)
    meetings = np.zeros((attempts, circles, circles, size), np.int64)
    circle = np.arange(places) % circles
    differences = (shifts[..., None, :] - shifts[..., :, None]) % size
    attempt = np.arange(attempts)[:, None, None, None]
    np.add.at(meetings, (attempt, circle[:, None], circle[None, :], differences), 1)
    meetings[:, np.arange(circles), np.arange(circles), 0] = FORBIDDEN
    return Circles(shifts, meetings)


def _spreads(meetings: Int) -> Int:
    """Return how much the meetings of two pairs differ at most, in each attempt."""
    possible = np.where(meetings >= FORBIDDEN, 0, meetings)
    highest, lowest = possible.max(axis=(1, 2, 3)), meetings.min(axis=(1, 2, 3))
    spreads: Int = highest - lowest
    return spreads


def _turn_one(state: Circles, noise: int, draws: Draws) -> None:
    """Take one entrant out of a base game of every attempt, and put in the best one of its circle."""
    attempts, rounds, places = state.shifts.shape
    circles, size = state.meetings.shape[2:]
    attempt = np.arange(attempts)
    base, place = draws.below(rounds, attempts), draws.below(places, attempts)
    # Everyone else of the game: the places after this one, around to the place before it.
    others = (place[:, None] + np.arange(1, places)) % places
    shift, other_shifts = (
        state.shifts[attempt, base, place],
        state.shifts[attempt[:, None], base[:, None], others],
    )
    circle, other_circles = (place % circles)[:, None], others % circles
    rows, cells = attempt[:, None], (circle, other_circles)
    _count(state.meetings, rows, cells, (other_shifts - shift[:, None]) % size, -1)

    candidates = np.arange(size)
    differences = (other_shifts[:, None, :] - candidates[None, :, None]) % size
    cost = state.meetings[rows[..., None], circle[..., None], other_circles[:, None, :], differences].sum(
        axis=2
    )
    cost += _mirrored(other_shifts[:, circles - 1 :: circles], size)
    keys = cost * 16 + draws.below(16 + noise, attempts, size)
    shift = keys.argmin(axis=1)
    _count(state.meetings, rows, cells, (other_shifts - shift[:, None]) % size, 1)
    state.shifts[attempt, base, place] = shift


def _count(meetings: Int, rows: Int, cells: tuple[Int, Int], differences: Int, times: int) -> None:
    """Count the meetings of one entrant with all others of its base game, seen from both sides."""
    circle, others = cells
    np.add.at(meetings, (rows, circle, others, differences), times)
    np.add.at(meetings, (rows, others, circle, -differences % meetings.shape[-1]), times)


def _mirrored(others: Int, size: int) -> Int:
    """Return for each place of a circle (C, m) how many pairs of others lie at equal distances on both sides.

    Such a pair adds to the same number of meetings twice, which the sum of the meetings so far does not show.
    """
    first, second = np.triu_indices(others.shape[1])
    mirror = (others[:, first] + others[:, second]) % size
    cells = (mirror + size * np.arange(len(others))[:, None]).reshape(-1)
    pairs = np.bincount(cells, minlength=size * len(others)).reshape(len(others), size)
    return pairs[:, 2 * np.arange(size) % size]
