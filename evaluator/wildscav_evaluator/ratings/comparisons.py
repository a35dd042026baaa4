"""The comparisons of all matches as arrays, in an order that does not depend on that of the matches."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from wildscav_evaluator.ratings.matches import RatedMatch, pairings


@dataclass(frozen=True)
class Comparisons:
    """C comparisons of two of N entrants, in G games."""

    names: tuple[str, ...]  # of the entrants, sorted
    game: NDArray[np.intp]  # (C,) from 0
    first: NDArray[np.intp]  # (C,) the entrant's index in names
    second: NDArray[np.intp]  # (C,)
    points: NDArray[np.float64]  # (C,) of the first: 1, 0.5 or 0
    games: NDArray[np.intp]  # (N,) games in which each entrant was compared

    @property
    def game_count(self) -> int:
        """The number of games."""
        return int(self.game.max()) + 1

    def win_matrix(self) -> NDArray[np.float64]:
        """Return the points of every entrant (rows) against every other one (columns), an (N, N) array."""
        wins = np.zeros((len(self.names), len(self.names)))
        np.add.at(wins, (self.first, self.second), self.points)
        np.add.at(wins, (self.second, self.first), 1.0 - self.points)
        return wins

    def connected(self) -> NDArray[np.intp]:
        """Return an (N,) array of the group of each entrant.

        Entrants of one group met each other, directly or through others. The groups are numbered by size, the
        largest first, and those of one size by their first names.
        """
        count = len(self.names)
        links = coo_array((np.ones(len(self.first)), (self.first, self.second)), shape=(count, count))
        _, labels = connected_components(links, directed=False)
        members = np.bincount(labels)
        _, starts = np.unique(labels, return_index=True)
        order = sorted(range(len(members)), key=lambda label: (-members[label], starts[label]))
        numbers = np.empty(len(members), np.intp)
        numbers[order] = np.arange(len(members))
        return np.asarray(numbers[labels], np.intp)


def compare_entrants(matches: Iterable[RatedMatch]) -> Comparisons:
    """Return the comparisons that follow from the places of some matches.

    Raises:
        ValueError: There are no matches.
    """
    ordered = sorted(matches)
    if not ordered:
        raise ValueError("there are no matches to rate")
    names = tuple(sorted({name for match in ordered for name in match.entrants}))
    games = sorted({match.game for match in ordered})
    index, number = {name: i for i, name in enumerate(names)}, {game: i for i, game in enumerate(games)}
    rows = [
        (number[match.game], index[one.first], index[one.second], one.points)
        for match in ordered
        for one in pairings(match)
    ]
    game, first, second = np.array([row[:3] for row in rows], np.intp).T
    points = np.array([row[3] for row in rows], np.float64)
    took_part = np.unique(np.concatenate([game * len(names) + first, game * len(names) + second]))
    counts = np.bincount(took_part % len(names), minlength=len(names))
    return Comparisons(names, game, first, second, points, counts)
