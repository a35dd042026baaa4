"""The intervals of bootstrap resampling that scores and ratings share."""

import numpy as np
from numpy.typing import NDArray
from scipy import special

CONFIDENCE = 0.95  # of every interval
SEED = 0  # of all resampling, so that an interval depends on the values alone and can be recomputed


def student_quantile(counts: NDArray[np.intp] | int, error: float, samples: int = 1) -> NDArray[np.float64]:
    """Return how many bootstrap standard errors wide each side of an interval is.

    It is Student's quantile, which is larger for few values, times a factor that corrects the bootstrap's
    standard error, which is too small for few values (Hesterberg, "What Teachers Should Know About the
    Bootstrap", *The American Statistician* 69, 2015, section 4.3).

    Args:
        counts: The number of values in each sample, at least two.
        error: The probability that an interval does not contain the true value, both sides together.
        samples: How many samples of so many values each are resampled by themselves.
    """
    counts = np.asarray(counts)
    quantiles = special.stdtrit(samples * (counts - 1), 1.0 - error / 2.0)
    return np.asarray(quantiles * np.sqrt(counts / (counts - 1)))


def expanded_tail(count: int, samples: int = 1) -> float:
    """Return the share of the resamples beyond each end of a percentile interval.

    For a large sample, it is half of the error; for a small one less, because its percentile interval would
    be too narrow.

    Args:
        count: The number of values in the sample, at least two.
        samples: How many samples of so many values each are resampled by themselves.
    """
    tail = special.ndtr(-student_quantile(count, 1.0 - CONFIDENCE, samples))
    return round(float(tail), 6)  # rounded, so that the library's last digit does not matter
