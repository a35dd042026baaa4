"""Strengths that explain the results of all matches best, whatever their order (Bradley & Terry 1952).

The probability that one entrant is placed above another is a logistic function of the difference of their
strengths; a tie counts as half a win for each. Newton's method finds the strengths, with sparse matrices: its
time grows with the pairs that met. In libraries that take a matrix of all pairs, it grows with the cube of
the entrants.

Every entrant also has one tie with an imaginary opponent of average strength. This weak prior keeps the
ratings of undefeated and winless entrants finite, and ceases to matter as matches are played.

The intervals are from a bootstrap over games, since the matches of one game depend on each other. The
strengths of each resample are one Newton step away from the fitted ones (Moulton & Zeger, "Bootstrapping
generalized linear models", *Computational Statistics & Data Analysis* 11, 1991). The imaginary ties are
resampled like games: otherwise, an undefeated entrant would have the same rating in every resample, and
thus appear to be exactly known.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, special
from scipy.sparse import coo_array, csr_array, eye_array, triu, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import LinearOperator, cg

from wildscav.errors import WildscavError
from wildscav_evaluator.ratings.matches import RatedMatch, pairings
from wildscav_evaluator.resampling import CONFIDENCE, SEED, student_quantile

AVERAGE = 1500.0  # the mean rating of the entrants that are compared with each other
ELO = 400.0 / math.log(10.0)  # points of rating that stand for odds of e : 1
DECIMALS = 1  # of stored ratings, so that a different processor's last bits do not matter
RESAMPLES = 2000
MAX_PICKS = 250_000  # at once, so that the processor's caches hold them
CLOSE = 1e-8  # change of a margin that ends the iterations; one more step follows
MAX_ITERATIONS = 1000  # a chain of 1,000 entrants, each beaten 1,000 times by the one before it, takes 214
SOLVED = 1e-3  # share of the gradient that is left when a step is found


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

    def met(self) -> tuple[csr_array, NDArray[np.float64], NDArray[np.float64]]:
        """Return the M pairs that met, and behind them the N imaginary ties.

        Returns:
            An (M + N, N) array that makes margins of strengths, the (M + N,) points of the first of each
            pair, and how many both had.
        """
        entrants = len(self.names)
        sides = np.concatenate([self.first, self.second]), np.concatenate([self.second, self.first])
        both = np.concatenate([self.points, 1.0 - self.points])
        points = coo_array((both, sides), shape=(entrants, entrants)).tocsr()
        met = triu(points + points.T).tocoo()
        signs, columns = np.tile([1.0, -1.0], met.nnz), np.stack(met.coords, axis=1).ravel()
        pairs = csr_array((signs, columns, 2 * np.arange(met.nnz + 1)), shape=(met.nnz, entrants))
        won = np.concatenate([points[met.coords], np.full(entrants, 0.5)])
        return vstack([pairs, eye_array(entrants)], "csr"), won, np.concatenate([met.data, np.ones(entrants)])

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
    """Return the comparisons that follow from the places of some matches; ValueError if there are none."""
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


@dataclass(frozen=True)
class Fit:
    """The ratings of N entrants, on the scale of Elo: 400 more are odds of 10 : 1."""

    names: tuple[str, ...]  # sorted
    ratings: NDArray[np.float64]  # (N,) the mean of each group is 1500
    deviations: NDArray[np.float64]  # (N,) standard errors of the ratings
    covariance: NDArray[np.float64]  # (N, N) of the ratings over the resamples
    games: NDArray[np.intp]  # (N,) games that each entrant played
    groups: NDArray[np.intp]  # (N,) from 0; ratings of different groups cannot be compared

    def interval(self, name: str) -> tuple[float, float] | None:
        """Return the 95 % interval of an entrant's rating; None after a single game."""
        index = self.names.index(name)
        if self.games[index] < 2:
            return None
        width = self.deviations[index] * float(student_quantile(int(self.games[index]), 1.0 - CONFIDENCE))
        rating = self.ratings[index]
        return float(rating - width), float(rating + width)

    def among(self, names: Sequence[str]) -> "Fit":
        """Return the ratings of some of the entrants."""
        rows = [self.names.index(name) for name in sorted(names)]
        arrays = (self.ratings[rows], self.deviations[rows], self.covariance[np.ix_(rows, rows)])
        return Fit(tuple(sorted(names)), *arrays, self.games[rows], self.groups[rows])


def fit(matches: Iterable[RatedMatch]) -> Fit:
    """Fit ratings to all matches at once, in any order; ValueError if there are none."""
    comparisons = compare_entrants(matches)
    strengths = fitted_strengths(comparisons)
    steps = _resampled_steps(comparisons, strengths)
    groups = comparisons.connected()
    # The first row is the step of the matches themselves: it removes what the iterations left.
    centred = _centred(strengths + steps, groups) * ELO
    covariance = np.cov(centred[1:], rowvar=False)
    return Fit(
        names=comparisons.names,
        ratings=AVERAGE + centred[0],
        deviations=np.sqrt(np.diag(covariance)),
        covariance=covariance,
        games=comparisons.games,
        groups=groups,
    )


def fitted_strengths(comparisons: Comparisons) -> NDArray[np.float64]:
    """Return the strengths that are most likely, given the points and the imaginary ties.

    They are (N,) natural logarithms of odds against the imaginary opponent. A step of Newton's is shortened
    so that it raises the likelihood, however far it goes (Sun & Tran-Dinh, "Generalized self-concordant
    functions", *Mathematical Programming* 178, 2019). WildscavError if the iterations do not converge.
    """
    margins, won, played = comparisons.met()
    gathered = margins.T.tocsr()  # sums up for each entrant what its pairs have
    strengths = np.zeros(len(comparisons.names))
    for _ in range(MAX_ITERATIONS):
        expected = special.expit(margins @ strengths)
        gradient = gathered @ (won - played * expected)
        step, is_solved = _newton_step(margins, gathered, gradient, played * expected * (1.0 - expected))
        reach = float(np.abs(margins @ step).max())
        if is_solved and not reach > CLOSE:
            return np.asarray(strengths)
        strengths += step * (math.log1p(reach) / reach)
    raise WildscavError(f"the ratings do not converge within {MAX_ITERATIONS} iterations")


def _newton_step(
    margins: csr_array, gathered: csr_array, gradient: NDArray[np.float64], weights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], bool]:
    """Return nearly the step to the maximum, and whether it was found; pairs have ``weights`` (M + N,)."""
    own = abs(gathered) @ weights
    shape = (len(gradient), len(gradient))
    information = LinearOperator(shape, matvec=lambda change: gathered @ (weights * (margins @ change)))
    step, left = cg(information, gradient, rtol=SOLVED, M=LinearOperator(shape, matvec=lambda one: one / own))
    return np.asarray(step), left == 0


def _resampled_steps(comparisons: Comparisons, strengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (1 + RESAMPLES, N) Newton steps of the strengths: of the matches and of the resamples."""
    expected = special.expit(strengths[comparisons.first] - strengths[comparisons.second])
    own = special.expit(strengths)  # expected points in the imaginary tie
    gradients = _gradients(comparisons, comparisons.points - expected, 0.5 - own)
    information = _information(comparisons, expected * (1.0 - expected), own * (1.0 - own))
    factor = linalg.cho_factor(information)
    total = gradients.sum(axis=0)[np.newaxis]
    sums = np.concatenate([total, *(counts @ gradients for counts in _multiplicities(gradients.shape[0]))])
    return np.asarray(linalg.cho_solve(factor, sums.T).T)


def _gradients(
    comparisons: Comparisons, residuals: NDArray[np.float64], imaginary: NDArray[np.float64]
) -> csr_array:
    """Return a (G + N, N) array: the part of each game and imaginary tie in the likelihood's gradient."""
    games, count = comparisons.game_count, len(comparisons.names)
    rows = np.concatenate([comparisons.game, comparisons.game, games + np.arange(count)])
    columns = np.concatenate([comparisons.first, comparisons.second, np.arange(count)])
    values = np.concatenate([residuals, -residuals, imaginary])
    return coo_array((values, (rows, columns)), shape=(games + count, count)).tocsr()


def _information(
    comparisons: Comparisons, weights: NDArray[np.float64], imaginary: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the (N, N) negative second derivatives of the logarithm of the likelihood."""
    count = len(comparisons.names)
    between = np.zeros((count, count))
    np.add.at(between, (comparisons.first, comparisons.second), weights)
    between += between.T
    return np.asarray(np.diag(between.sum(axis=1) + imaginary) - between)


def _multiplicities(units: int) -> Iterable[NDArray[np.float64]]:
    """Yield how often each of the units is in each resample: arrays of some rows, RESAMPLES rows in all."""
    generator = np.random.Generator(np.random.Philox(SEED))
    at_once = max(1, MAX_PICKS // units)
    for start in range(0, RESAMPLES, at_once):
        rows = min(at_once, RESAMPLES - start)
        picks = generator.integers(0, units, size=(rows, units))
        picks += units * np.arange(rows)[:, np.newaxis]
        yield np.bincount(picks.ravel(), minlength=rows * units).reshape(rows, units).astype(np.float64)


def _centred(strengths: NDArray[np.float64], groups: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return strengths, one set in each row, with a mean of zero in each group of entrants."""
    members = np.bincount(groups)
    means = np.stack([strengths[:, groups == group].sum(axis=1) for group in range(len(members))], axis=1)
    return strengths - (means / members)[:, groups]
