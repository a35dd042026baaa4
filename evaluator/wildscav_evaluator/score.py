"""Scores: what the matches of an evaluation say about a submission, and how sure that is."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.results import Summary

RESAMPLES = 2000
CONFIDENCE = 0.95


def summarize(values: Sequence[float], seed: int) -> Summary:
    """Return mean, sample standard deviation and bootstrap interval of a metric over matches.

    The interval is the percentile bootstrap's (Efron & Tibshirani, *An Introduction to the Bootstrap*,
    1993, chapter 13). Equal seeds and equal counts resample the same matches, so that the intervals of
    submissions that played the same suite rest on the same draws.

    Args:
        values: The metric in every match played, in the order of the suite; one at least.
        seed: Any whole number.
    """
    count = len(values)
    # Exact sums: no result depends on how a sum was split.
    mean = math.fsum(values) / count
    squares = math.fsum((value - mean) ** 2 for value in values)
    deviation = math.sqrt(squares / (count - 1)) if count > 1 else None
    low, high = interval(np.asarray(values, np.float64), seed)
    return Summary(mean=mean, std=deviation, low=low, high=high)


def interval(values: NDArray[np.float64], seed: int) -> tuple[float, float]:
    """Return the bootstrap interval of the mean; of a single value, just that value."""
    generator = np.random.Generator(np.random.Philox(seed % 2**64))
    picks = generator.integers(0, len(values), size=(RESAMPLES, len(values)))
    means = values[picks].sum(axis=1) / len(values)
    tail = (1.0 - CONFIDENCE) / 2.0 * 100.0
    low, high = np.percentile(means, (tail, 100.0 - tail))
    return float(low), float(high)
