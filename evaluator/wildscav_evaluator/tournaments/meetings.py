"""How often entrants meet each other in games, and swaps of entrants that make it more even."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Word, philox
from wildscav_engine.compilation.kernel import kernel
from wildscav_evaluator.tournaments.draws import Draws

Int = NDArray[np.int64]

MANY_CELLS = 4_000_000  # pairs of places that are listed one by one
WORK = 40_000_000  # swaps looked at: about half a second
MAX_ATTEMPTS = 8
STEPS_PER_GAME = 200, 20_000  # of an attempt at least, if there are several; and of all at most
CHECKS = 32  # of an attempt, whether it is even enough
FORBIDDEN = 1 << 20  # counted meetings of a pair that must not meet: more than a schedule has
HARMFUL = 64  # of 4096 swaps at the start may do harm; fewer and fewer later
LOW, HIGH = np.uint64(0xFFFFFFFF), np.uint64(32)
FACTOR, TERM, TOP = np.uint64(6364136223846793005), np.uint64(1442695040888963407), np.uint64(60)


def count_meetings(games: Int, entrants: int) -> Int:
    """Return in how many games (..., P) each pair plays, (n, n); the diagonal counts each entrant's games."""
    places = games.shape[-1]
    games = games.reshape(-1, places)
    if games.size * places <= MANY_CELLS:
        cells = (games[:, :, None] * entrants + games[:, None, :]).reshape(-1)
        return np.bincount(cells, minlength=entrants * entrants).reshape(entrants, entrants).astype(np.int64)
    # The product of the matrix of who plays in which game with itself. Its numbers are exact: far below
    # 2**24.
    played = np.zeros((len(games), entrants), np.float32)
    np.put_along_axis(played, games, 1.0, axis=1)
    return (played.T @ played).astype(np.int64)


def spread_of(meetings: Int, groups: Sequence[int]) -> int:
    """Return the most by which the meetings of two pairs of different groups differ; 0 without such pairs."""
    group = np.asarray(groups)
    met = meetings[group[:, None] != group[None, :]]
    return int(met.max() - met.min()) if met.size else 0


def even_out(games: Int, groups: Sequence[int], draws: Draws) -> Int:
    """Return games (R, B, P) after swaps of entrants between games of a round: the best of several attempts.

    An attempt ends as soon as the meetings of any two pairs differ by one at most.

    Args:
        games: The start, in which no two entrants of a group meet.
        groups: (n,) the group of each entrant.
    """
    rounds, count, places = games.shape
    if count == 1 or places == 1:
        return games
    least, most = (number * rounds * count for number in STEPS_PER_GAME)
    steps = min(WORK // places**2, most)
    attempts = min(max(1, steps // least), MAX_ATTEMPTS)
    found = [_attempt(games.copy(), groups, steps // attempts, draws) for _ in range(attempts)]
    return min(found, key=lambda one: one[0])[1]


def _attempt(games: Int, groups: Sequence[int], steps: int, draws: Draws) -> tuple[tuple[int, int], Int]:
    """Return games after so many steps at most, and a key by which the most even ones are the least."""
    group = np.asarray(groups)
    apart = group[:, None] == group[None, :]
    meetings = count_meetings(games, len(group))
    meetings[apart] = FORBIDDEN
    alone = np.empty(games.shape[2], np.int64)
    for turn in range(CHECKS):
        if spread_of(meetings, groups) <= 1:
            break
        harmful = HARMFUL * (CHECKS - turn) // CHECKS
        swap(games, meetings, alone, draws.words(1)[0], steps // CHECKS, harmful)
    met = np.where(apart, 0, meetings)
    return (spread_of(meetings, groups), int((met * met).sum())), games


@kernel
def swap(games: Int, meetings: Int, alone: Int, seed: Word, steps: int, harmful: int) -> None:
    """Lower the sum of the squares of the pairs' meetings, by the best swap between two games at each step.

    Args:
        games: (R, B, P) entrants; changed.
        meetings: (N, N) games of each pair, and FORBIDDEN for those that must not meet; changed.
        alone: (P,) scratch memory.
        seed: Of the choice of the games.
        steps: How often two games of a round are looked at.
        harmful: Of 4096 swaps, how many are made that do a little harm.
    """
    rounds, count = games.shape[:2]
    for step in range(steps):
        one, two = philox(seed, 0, 0, 0, step)
        played = games[int(one & LOW) % rounds]
        number = int(one >> HIGH) % count
        first, second = played[number], played[(number + 1 + int(two & LOW) % (count - 1)) % count]
        change, leaving, coming = _best_swap(meetings, first, second, one, alone)
        mood = int(two >> HIGH) % 4096
        if change <= (mood < harmful) + (mood < harmful // 4):
            left, right = first[leaving], second[coming]
            _count(meetings, left, first, leaving, -1)
            _count(meetings, right, second, coming, -1)
            _count(meetings, left, second, coming, 1)
            _count(meetings, right, first, leaving, 1)
            first[leaving], second[coming] = right, left


@kernel
def _best_swap(meetings: Int, first: Int, second: Int, word: Word, alone: Int) -> tuple[int, int, int]:
    """Return the best swap of two games' entrants: half of its change of the sum, and both places.

    Of equally good swaps, the random word decides. ``alone`` is (P,) scratch memory.
    """
    places = len(first)
    best, leaving, coming = FORBIDDEN << 10, 0, 0
    for j in range(places):
        alone[j] = _alone(meetings, second, j, first)
    for i in range(places):
        gone = _alone(meetings, first, i, second)
        for j in range(places):
            change = gone + alone[j] - 2 * meetings[first[i], second[j]]
            word = word * FACTOR + TERM
            key = change * 16 + int(word >> TOP)
            if first[i] != second[j] and key < best:
                best, leaving, coming = key, i, j
    both = 0  # who plays in both games meets the swapped ones as often as before
    for k in range(places):
        for j in range(places):
            both += first[k] == second[j]
    return (best >> 4) + 2 * (places - 1 - both), leaving, coming


@kernel
def _alone(meetings: Int, game: Int, place: int, other: Int) -> int:
    """Return how much more an entrant of a game has met those of the other game than those of its own."""
    more = 0
    for k in range(len(game)):
        more += meetings[game[place], other[k]]
        if k != place:
            more -= meetings[game[place], game[k]]
    return more


@kernel
def _count(meetings: Int, entrant: int, game: Int, left_out: int, times: int) -> None:
    """Count the meetings of an entrant with those of a game, without the one at a place."""
    for place in range(len(game)):
        if place != left_out:
            meetings[entrant, game[place]] += times
            meetings[game[place], entrant] += times
