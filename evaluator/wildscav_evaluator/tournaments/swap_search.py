"""A search that swaps entrants between games of one round until all pairs meet about equally often.

It lowers the sum of the squares of the pairs' meetings. Each step takes the games of a round two by two,
looks at every swap of an entrant of the one with an entrant of the other, and makes the best swap if it does
no harm, and now and then also if it does a little. Several attempts run at the same time, as rows of the same
arrays.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import count_meetings

Int = NDArray[np.int64]

CHECKED_EVERY = 8  # steps
FORBIDDEN = 1 << 20  # counted meetings of a pair that must not meet: more than a schedule has
HARMFUL = 8  # of 256 swaps at the start; fewer and fewer later


class _Attempts(NamedTuple):
    """C attempts at R rounds of B games with P places."""

    games: Int  # (C, R, B, P) entrants
    meetings: Int  # (C, N, N) games of each pair; FORBIDDEN for pairs that must not meet


class _Pairs(NamedTuple):
    """Q pairs of games of a round, in each of C attempts."""

    attempt: Int  # (C, 1)
    round: Int  # (C, Q)
    first: Int  # (C, Q) games of the round
    second: Int


def search_swaps(games: Int, forbidden: NDArray[np.bool_], steps: int, draws: Draws, width: int = 1) -> Int:
    """Return the games of the best attempt, (R, B, P).

    Args:
        games: (C, R, B, P) the start of each attempt, without forbidden pairs. It is changed.
        forbidden: (N, N) the pairs that must not meet; everybody with themselves in any case.
        steps: At most so many; a search ends as soon as the meetings of an attempt differ by one at most.
        draws: The source of randomness.
        width: In how many rounds each step makes swaps.
    """
    state = _Attempts(games, _count(games, forbidden))
    if games.shape[2] > 1:
        for step in range(steps):
            if step % CHECKED_EVERY == 0 and _spreads(state.meetings).min() <= 1:
                break
            _step(state, HARMFUL * (steps - step) // steps, width, draws)
    met = np.where(forbidden, 0, state.meetings)
    best: Int = state.games[np.lexsort(((met * met).sum(axis=(1, 2)), _spreads(state.meetings)))[0]]
    return best


def _count(games: Int, forbidden: NDArray[np.bool_]) -> Int:
    meetings = np.stack([count_meetings(attempt, len(forbidden)) for attempt in games])
    meetings[:, forbidden] = FORBIDDEN
    return meetings


def _spreads(meetings: Int) -> Int:
    """Return how much the meetings of two pairs differ at most, in each attempt."""
    possible = np.where(meetings >= FORBIDDEN, 0, meetings)
    spreads: Int = possible.max(axis=(1, 2)) - meetings.min(axis=(1, 2))
    return spreads


def _step(state: _Attempts, harmful: int, width: int, draws: Draws) -> None:
    """Swap entrants between the games of random rounds, in every attempt."""
    pairs = _draw_pairs(state.games.shape, width, draws)
    first = state.games[pairs.attempt, pairs.round, pairs.first]  # (C, Q, P)
    second = state.games[pairs.attempt, pairs.round, pairs.second]
    changes = _changes(state.meetings, pairs.attempt, first, second)
    count, pairs_of_games, places = first.shape
    keys = changes.reshape(count, pairs_of_games, -1) * 16 + draws.nibbles(
        count, pairs_of_games, places * places
    )
    best = keys.argmin(axis=2)
    change = np.take_along_axis(keys, best[..., None], axis=2)[..., 0] >> 4
    mood = draws.below(256, count, pairs_of_games)
    limit = (mood < harmful).astype(np.int64) + (mood < harmful // 4)
    attempt, pair = np.nonzero(change <= limit)
    leaving, coming = best[attempt, pair] // places, best[attempt, pair] % places
    _swap_meetings(state.meetings, attempt, (first[attempt, pair], leaving), (second[attempt, pair], coming))
    row = np.arange(len(attempt))
    rounds = pairs.round[attempt, pair]
    state.games[attempt, rounds, pairs.first[attempt, pair], leaving] = second[attempt, pair][row, coming]
    state.games[attempt, rounds, pairs.second[attempt, pair], coming] = first[attempt, pair][row, leaving]


def _draw_pairs(shape: tuple[int, ...], width: int, draws: Draws) -> _Pairs:
    attempts, rounds, games, _ = shape
    half = games // 2
    chosen = draws.below(rounds, attempts, 1) if width == 1 else draws.orders(attempts, rounds)[:, :width]
    order = draws.orders(attempts, chosen.shape[1], games)
    return _Pairs(
        np.arange(attempts)[:, None],
        np.repeat(chosen, half, axis=1),
        order[..., :half].reshape(attempts, -1),
        order[..., half : 2 * half].reshape(attempts, -1),
    )


def _changes(meetings: Int, attempt: Int, first: Int, second: Int) -> Int:
    """Return by how much each swap (C, Q, P, P) changes half the sum of the squares of the meetings."""
    row = attempt[..., None, None]
    between = meetings[row, first[..., :, None], second[..., None, :]]
    alone = FORBIDDEN + first.shape[-1] - 1
    left = meetings[row, first[..., :, None], first[..., None, :]].sum(axis=3) - alone
    right = meetings[row, second[..., :, None], second[..., None, :]].sum(axis=3) - alone
    changes: Int = (between.sum(axis=3) - left)[..., :, None] + (between.sum(axis=2) - right)[..., None, :]
    changes -= 2 * between
    # Who plays in both games meets the swapped ones as often as before.
    changes -= 2 * (first[..., :, None] == second[..., None, :]).sum(axis=(2, 3))[..., None, None]
    return changes


def _swap_meetings(meetings: Int, attempt: Int, first: tuple[Int, Int], second: tuple[Int, Int]) -> None:
    """Count the meetings anew after swaps of one entrant (its games, and its place in them) with another."""
    (left, leaving), (right, coming) = first, second
    row, places = np.arange(len(left)), left.shape[1]
    others = np.concatenate([left, right], axis=1)
    times = np.concatenate([-np.ones_like(left), np.ones_like(right)], axis=1)
    times[row, leaving] = 0
    times[row, places + coming] = 0
    games = attempt[:, None]
    for entrant, sign in ((left[row, leaving, None], 1), (right[row, coming, None], -1)):
        np.add.at(meetings, (games, entrant, others), sign * times)
        np.add.at(meetings, (games, others, entrant), sign * times)
