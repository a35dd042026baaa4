"""Which ranks are possible: who cannot be told apart is tied.

All intervals of a board hold at once with a probability of 95 % (Bonferroni's correction), so identical
submissions are separated on at most one board of twenty, however many there are.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.resampling import CONFIDENCE, student_quantile

FEWEST_SHARED_MATCHES = 6  # in fewer, one of two equals wins all of them in more than one case of twenty


def rank_ranges(better: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the best and the worst rank that each may have.

    Args:
        better: (N, N), whether the one of the row is significantly better than the one of the column.

    The best possible rank is one more than the number of those that are significantly better, and the worst
    leaves room for those that are significantly worse (Al Mohamad, Goeman & van Zwet, "Simultaneous
    confidence intervals for ranks with application to ranking institutions", *Biometrics* 78, 2022).
    """
    count = len(better)
    above, below = better.sum(axis=0), better.sum(axis=1)
    return [(1 + int(above[one]), count - int(below[one])) for one in range(count)]


def better_in_pairs(scores: NDArray[np.float64], *, lower_is_better: bool) -> NDArray[np.bool_]:
    """Return who is significantly better than whom, by the differences in the matches that both played.

    Args:
        scores: (N, M), the score of each of N submissions in each of the same M matches.

    Returns:
        (N, N): whether the submission of the row is better than that of the column.
    """
    count, matches = scores.shape
    if matches < FEWEST_SHARED_MATCHES or count < 2:
        return np.zeros((count, count), np.bool_)
    centred = scores - scores.mean(axis=1, keepdims=True)
    covariance = centred @ centred.T / matches
    variances = np.diag(covariance)
    errors = np.sqrt(np.maximum(variances[:, np.newaxis] + variances - 2.0 * covariance, 0.0) / matches)
    width = student_quantile(matches, (1.0 - CONFIDENCE) / (count * (count - 1) / 2))
    means = scores.mean(axis=1)
    lead = means[:, np.newaxis] - means
    # Rounded, so that the last bits of a sum decide nothing.
    return np.asarray(np.round((-lead if lower_is_better else lead) - width * errors, 9) > 0.0)
