"""Who can be told apart: ranks, and bands of entrants whose ratings do not differ significantly.

Two entrants are told apart if the bootstrap interval of the difference of their ratings excludes zero. The
intervals of all pairs hold at once with a probability of 95 % (Bonferroni's correction), so identical
entrants are separated in at most one of twenty tournaments, however many there are.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.ratings.fit import DECIMALS, Fit
from wildscav_evaluator.resampling import CONFIDENCE, student_quantile

# In fewer games, one of two identical entrants is ahead in all of them in more than one of twenty cases:
# 2 · 0.5⁵ is 6 %.
FEWEST_GAMES = 6


@dataclass(frozen=True)
class Ranking:
    """Entrants from the best to the worst, and who cannot be told apart."""

    names: tuple[str, ...]  # by group, and in it by rating
    ranks: dict[str, tuple[int, int]]  # the best and the worst rank that each may have in its group, from 1
    bands: tuple[tuple[str, ...], ...]  # every two entrants of a band cannot be told apart; bands may overlap


def rank_entrants(fit: Fit) -> Ranking:
    """Rank entrants, and find those that cannot be told apart.

    The best possible rank of an entrant is one more than the number of entrants that are significantly
    better, and its worst possible rank leaves room for those that are significantly worse. With a
    probability of 95 %, all true ranks lie between these two (Al Mohamad, Goeman & van Zwet,
    "Simultaneous confidence intervals for ranks with application to ranking institutions", *Biometrics* 78,
    2022).
    """
    # By rounded ratings, so that the last bits decide nothing.
    ratings = np.round(fit.ratings, DECIMALS)
    order = sorted(range(len(fit.names)), key=lambda i: (fit.groups[i], -ratings[i], fit.names[i]))
    better = significantly_better(fit)
    sizes = np.bincount(fit.groups)
    ranks = {
        fit.names[i]: (1 + int(better[:, i].sum()), int(sizes[fit.groups[i]] - better[i].sum()))
        for i in order
    }
    runs = _runs(better | better.T | (fit.groups[:, np.newaxis] != fit.groups), order)
    names = tuple(fit.names[i] for i in order)
    return Ranking(names, ranks, tuple(names[start:end] for start, end in runs))


def significantly_better(fit: Fit) -> NDArray[np.bool_]:
    """Return an (N, N) array: whether the entrant of the row is significantly better than the column's."""
    comparable = fit.groups[:, np.newaxis] == fit.groups
    pairs = (int(comparable.sum()) - len(fit.names)) // 2
    games = np.minimum(fit.games[:, np.newaxis], fit.games)
    widths = student_quantile(np.maximum(fit.games, 2), (1.0 - CONFIDENCE) / max(pairs, 1))
    width = np.maximum(widths[:, np.newaxis], widths)  # that of fewer games
    variances = np.diag(fit.covariance)
    errors = np.sqrt(np.maximum(variances[:, np.newaxis] + variances - 2.0 * fit.covariance, 0.0))
    differences = fit.ratings[:, np.newaxis] - fit.ratings
    return np.asarray(comparable & (games >= FEWEST_GAMES) & (differences > width * errors))


def _runs(apart: NDArray[np.bool_], order: list[int]) -> list[tuple[int, int]]:
    """Return the longest runs of places in an order within which no two entrants are told apart."""
    ends, end = [], 0
    for start in range(len(order)):
        end = max(end, start + 1)
        while end < len(order) and not apart[order[end], order[start:end]].any():
            end += 1
        ends.append(end)
    kept = [0, *(start for (start, (before, end)) in enumerate(pairwise(ends), 1) if end > before)]
    return [(start, ends[start]) for start in kept]
