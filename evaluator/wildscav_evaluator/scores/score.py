"""Scores: the means of a submission's metrics over its matches, and their uncertainty."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.output.results import MatchRow, MetricInfo, Summary
from wildscav_evaluator.resampling import SEED, expanded_tail

RESAMPLES = 10_000


def summary(metrics: Iterable[MetricInfo], rows: Iterable[MatchRow]) -> dict[str, Summary]:
    """Return every metric over the matches that have a result, including those in which the agent failed.

    A metric that the results of an older version lack is left out.
    """
    played = [row.metrics for row in rows if row.metrics is not None]
    if not played:
        return {}
    return {
        metric.name: summarize([values[metric.name] for values in played])
        for metric in metrics
        if all(metric.name in values for values in played)
    }


def summarize(values: Sequence[float]) -> Summary:
    """Return mean, sample standard deviation and bootstrap interval of a metric over matches.

    ``values`` are in the order of the suite; there is at least one.
    """
    count, mean = len(values), mean_of(values)
    squares = math.fsum((value - mean) ** 2 for value in values)
    deviation = math.sqrt(squares / (count - 1)) if count > 1 else None
    low, high = interval(np.asarray(values, np.float64))
    return Summary(mean=mean, std=deviation, low=low, high=high)


def mean_of(values: Sequence[float]) -> float:
    """Return the mean of a metric over matches, at least one."""
    return math.fsum(values) / len(values)  # an exact sum does not depend on how it is split


def interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the bootstrap interval of the mean; for a single value, that value twice.

    The percentile bootstrap (Efron & Tibshirani, *An Introduction to the Bootstrap*, 1993, chapter 13), with
    the percentiles set further out for small samples, where it is too narrow (Hesterberg, "What Teachers
    Should Know About the Bootstrap", *The American Statistician* 69, 2015, section 4.3). Of a handful of
    values, that interval spans all resamples. Equal counts resample the same matches, so that the intervals
    of submissions that played the same suite are based on the same draws.
    """
    count = len(values)
    if count == 1:
        return float(values[0]), float(values[0])
    means = values[_picks(count)].sum(axis=1) / count
    tail = 100.0 * expanded_tail(count)
    low, high = np.percentile(means, (tail, 100.0 - tail))
    return float(low), float(high)


@lru_cache(maxsize=2)
def _picks(count: int) -> NDArray[np.int64]:
    """Return which of so many values each resample takes."""
    return np.random.Generator(np.random.Philox(SEED)).integers(0, count, size=(RESAMPLES, count))
