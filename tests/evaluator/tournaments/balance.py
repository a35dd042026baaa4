"""How balanced a schedule is."""

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.meetings import count_meetings, spread_of
from wildscav_evaluator.tournaments.schedule import Schedule

Int = NDArray[np.int64]


def pair_counts(schedule: Schedule) -> Int:
    """In how many games each two entrants play, with or against each other: (n, n), the diagonal 0."""
    return _pairs_in(_entrants_of_games(schedule), schedule)


def teammate_counts(schedule: Schedule) -> Int:
    """In how many games each two entrants are teammates: (n, n), the diagonal 0."""
    size = schedule.teams.count(0) if schedule.mixed else 1
    return _pairs_in(_entrants_of_games(schedule).reshape(-1, size), schedule)


def seat_counts(schedule: Schedule) -> Int:
    """In how many matches each entrant has each seat: (n, K)."""
    counts = np.zeros((len(schedule.groups), len(schedule.teams)), np.int64)
    np.add.at(counts, (schedule.players, np.arange(len(schedule.teams))), 1)
    return counts


def spread(schedule: Schedule) -> int:
    """By how many games the meetings of two pairs differ at most, among the pairs that may meet."""
    return spread_of(pair_counts(schedule), schedule.groups)


def _entrants_of_games(schedule: Schedule) -> Int:
    """Return the entrants of each game, each named once: (G, P)."""
    first = np.flatnonzero(np.diff(schedule.games, prepend=-1))
    apart = 1 if schedule.mixed else schedule.teams.count(0)
    return schedule.players[first, ::apart].astype(np.int64)


def _pairs_in(games: Int, schedule: Schedule) -> Int:
    counts = count_meetings(games, len(schedule.groups))
    np.fill_diagonal(counts, 0)
    return counts
