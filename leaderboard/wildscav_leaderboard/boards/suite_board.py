"""The board of a suite: every submission plays the same matches on hidden seeds.

A team stands on it with the submission that has the best mean score, among those that have played all their
matches. Of the others it tells only how many are played: each change of a mean would tell one match. Ranks
come from the differences match by match, since all play the same ones.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache

import numpy as np

from wildscav_evaluator.output.results import MetricInfo, Summary
from wildscav_evaluator.scores.score import mean_of, summarize
from wildscav_leaderboard.boards.documents import Entry, SuiteBoard, SuiteRow
from wildscav_leaderboard.boards.ranks import better_in_pairs, rank_ranges
from wildscav_leaderboard.seasons.editions import Conditions


@dataclass(frozen=True)
class SuiteResults:
    """What is known of a submission on a track."""

    entry: Entry
    planned: int  # matches
    faults: int
    metrics: dict[int, dict[str, float]]  # of each match that was played, by its number in the suite

    @property
    def submission(self) -> int:
        """The number of the submission."""
        return self.entry.submission or 0

    @property
    def is_complete(self) -> bool:
        """Whether all matches were played."""
        return 0 < self.planned == len(self.metrics)

    def measures(self, metric: str) -> bool:
        """Return whether every match that was played has a metric."""
        return all(metric in values for values in self.metrics.values())

    def values(self, metric: str) -> list[float]:
        """Return a metric in every match, in the order of the suite."""
        return [self.metrics[number][metric] for number in sorted(self.metrics)]


def suite_board(
    track: str,
    conditions: Conditions,
    metrics: tuple[MetricInfo, ...],
    results: Sequence[SuiteResults],
    updated: datetime,
) -> SuiteBoard:
    """Return the board that follows from the results of all active submissions.

    Args:
        conditions: Under which they were played.
        metrics: Of the track; the first is the score. Others that results of an older version lack are left
            out.
    """
    score, *others = metrics
    metrics = (score, *(one for one in others if all(result.measures(one.name) for result in results)))
    sign = 1.0 if score.lower_is_better else -1.0

    def key(one: SuiteResults) -> tuple[float, int]:
        return sign * mean_of(one.values(score.name)), one.submission

    ranked = _best_of_teams(sorted((one for one in results if one.is_complete), key=key))
    teams = {one.entry.team for one in ranked}
    waiting = sorted((one for one in results if one.entry.team not in teams), key=lambda one: one.submission)
    ranges = _ranges(ranked, score)
    rows = [  # of those that wait, a team's newest one
        *(_row(one, *ranks, metrics) for one, ranks in zip(ranked, ranges, strict=True)),
        *(_row(one, None, None, ()) for one in {one.entry.team: one for one in waiting}.values()),
    ]
    return SuiteBoard(
        track=track,
        conditions=conditions,
        updated=updated,
        metrics=metrics,
        entered=tuple(sorted(one.submission for one in results)),
        rows=tuple(rows),
    )


def _summaries(one: SuiteResults, metrics: Iterable[MetricInfo]) -> dict[str, Summary]:
    if not one.metrics:
        return {}
    return {metric.name: _summary(tuple(one.values(metric.name))) for metric in metrics}


@lru_cache(maxsize=10_000)
def _summary(values: tuple[float, ...]) -> Summary:
    """Return the summary of some values, which takes long: a board changes in few of its rows at a time."""
    return summarize(values)


def _best_of_teams(ordered: Iterable[SuiteResults]) -> list[SuiteResults]:
    """Return the first of each team."""
    first: dict[str, SuiteResults] = {}
    for one in ordered:
        first.setdefault(one.entry.team, one)
    return list(first.values())


def _ranges(ranked: Sequence[SuiteResults], score: MetricInfo) -> list[tuple[int, int]]:
    if not ranked:
        return []
    scores = np.array([one.values(score.name) for one in ranked], np.float64)
    return rank_ranges(better_in_pairs(scores, lower_is_better=score.lower_is_better))


def _row(
    one: SuiteResults, rank: int | None, last_rank: int | None, metrics: Iterable[MetricInfo]
) -> SuiteRow:
    return SuiteRow(
        rank=rank,
        last_rank=last_rank,
        **one.entry.shown,
        matches=len(one.metrics),
        planned=one.planned,
        faults=0 if rank is None else one.faults,
        metrics=_summaries(one, metrics),
    )
