"""Deciding which of two submissions is better, or which version of one, from the matches that both played."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np

from wildscav.errors import UserError
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.output.json_files import FileModel, FileModelError, WithOptionalFields
from wildscav_evaluator.output.layout import COMPARISON_FILE, RESULTS_FILE
from wildscav_evaluator.output.numbered_folders import NUMBERED, identity_in, numbered
from wildscav_evaluator.output.results import (
    Evaluation,
    KeptLimits,
    MetricInfo,
    ModelTerms,
    OtherInterface,
    Results,
    Versions,
    read_results,
)
from wildscav_evaluator.scores.score import interval

# With fewer pairs, one submission wins all of them by chance in more than one case of twenty: 2 · 0.5⁵ is 6
# %.
FEWEST_PAIRS = 6
MAX_SEARCHED = 50  # earlier evaluations, at most

Verdict = Literal["first", "second", "tied", "too few"]


class Difference(FileModel):
    """One metric of two submissions over the matches that both played."""

    metric: MetricInfo
    first: float  # mean of the first submission
    second: float
    difference: float  # mean of first - second, match by match
    low: float  # of the paired bootstrap 95 % interval of that mean
    high: float
    verdict: Verdict  # which submission is better


class Comparison(WithOptionalFields):
    """Two submissions on one track."""

    omitted = ("interfaces",)

    track: str
    first: str
    second: str
    # By which they play; omitted if it is the same.
    interfaces: tuple[OtherInterface | None, OtherInterface | None] | None = None
    pairs: int  # matches for which both have a result
    dropped: int  # matches for which one of them has none, by the platform's fault
    differences: tuple[Difference, ...]  # by metric; the first is the score

    @property
    def verdict(self) -> Verdict:
        """The submission with the better score; "too few" if nothing was compared."""
        return self.differences[0].verdict if self.differences else "too few"


class Comparisons(WithOptionalFields):
    """The file of a comparison."""

    omitted = ("clock", "model")

    format: Literal[2] = 2
    versions: Versions  # with which they were played
    suite: str
    seed: str  # or the beginning of the commitment, if it is hidden
    rounds: int
    sandbox: str  # in which agents ran
    limits: dict[str, KeptLimits]  # of each agent in it, by track
    clock: ClockChoice | None = None  # of all matches; omitted if they had the suite's own
    model: ModelTerms | None = None  # that agents could ask; omitted if there was none
    comparisons: tuple[Comparison, ...]


def compare(results: Results, first: str, second: str) -> Comparisons:
    """Compare two submissions on every track of an evaluation in which both take part."""
    by_name = {(one.submission, one.track): one for one in results.evaluations}
    return Comparisons.about(
        results,
        format=2,
        seed=results.seed_label,
        comparisons=tuple(
            compare_evaluations(by_name[first, track], by_name[second, track]) for track in results.tracks
        ),
    )


def compare_evaluations(first: Evaluation, second: Evaluation) -> Comparison:
    """Compare two evaluations on the same matches of one track."""
    others = {row.index: row.metrics for row in second.matches}
    pairs = [
        (row.metrics, other)
        for row in first.matches
        if row.metrics is not None and (other := others.get(row.index)) is not None
    ]
    return Comparison(
        track=first.track,
        first=first.submission,
        second=second.submission,
        interfaces=None if first.interface == second.interface else (first.interface, second.interface),
        pairs=len(pairs),
        dropped=max(len(first.matches), len(second.matches)) - len(pairs),
        differences=tuple(_differences(first.metrics, pairs)) if pairs else (),
    )


def _differences(
    metrics: tuple[MetricInfo, ...], pairs: list[tuple[dict[str, float], dict[str, float]]]
) -> Iterator[Difference]:
    for metric in metrics:
        if not all(metric.name in one and metric.name in other for one, other in pairs):
            continue  # the results of an older version lack it
        values = np.array([(one[metric.name], other[metric.name]) for one, other in pairs], np.float64)
        differences = values[:, 0] - values[:, 1]
        low, high = interval(differences)
        first, second = values.mean(axis=0).tolist()
        yield Difference(
            metric=metric,
            first=first,
            second=second,
            difference=float(differences.mean()),
            low=low,
            high=high,
            verdict=judge(low, high, len(pairs), lower_is_better=metric.lower_is_better),
        )


def judge(low: float, high: float, pairs: int, *, lower_is_better: bool) -> Verdict:
    """Return which submission is better, given the interval of first - second over some pairs of matches."""
    if pairs < FEWEST_PAIRS:
        return "too few"
    if low <= 0.0 <= high:
        return "tied"
    return "first" if (high < 0.0) == lower_is_better else "second"


def check_comparison(out: Path, results: Results) -> str:
    """Return why a folder's comparison, if any, does not follow from its results; empty if it does."""
    path = out / COMPARISON_FILE
    try:
        reported = Comparisons.read(path)
    except FileNotFoundError:
        return ""
    except FileModelError as error:
        return f"{path} is not a comparison: {error}"
    names = list(dict.fromkeys(one.submission for one in results.evaluations))
    with contextlib.suppress(KeyError, ValueError):  # raised if the results lack a submission or metric
        if len(names) == 2 and reported == compare(results, *names):
            return ""
    return f"{COMPARISON_FILE} is not what {RESULTS_FILE} gives"


class Change(FileModel):
    """One submission on one track, now and when it was last evaluated with other files."""

    folder: str  # of the earlier evaluation
    version: str  # the version that was evaluated there
    comparison: Comparison  # first: now, second: then


def changes_since_last(results: Results, out: Path) -> tuple[Change, ...]:
    """Compare every submission with its last evaluation on the same matches with other files.

    If the folder has no number, its predecessors are not known.
    """
    wanted = {(one.submission, one.track): one for one in results.evaluations}
    changes: dict[tuple[str, str], Change] = {}
    for folder, earlier in _earlier(results, out):
        for then in earlier.evaluations:
            key = then.submission, then.track
            now = wanted.get(key)
            if (
                now is None
                or key in changes
                or then.digest == now.digest
                or then.interface != now.interface
                or not _same(earlier, results, then)
            ):
                continue
            comparison = compare_evaluations(now, then)
            if comparison.differences:
                changes[key] = Change(folder=folder.name, version=then.version, comparison=comparison)
        if len(changes) == len(wanted):
            break
    return tuple(changes[key] for key in wanted if key in changes)


def _earlier(results: Results, out: Path) -> Iterator[tuple[Path, Results]]:
    """Yield the other numbered evaluations that share a submission with this one, the latest first."""
    if not NUMBERED.fullmatch(out.name):
        return
    names = {one.submission for one in results.evaluations}
    for folder in numbered(out.parent)[: -MAX_SEARCHED - 1 : -1]:
        identity = identity_in(folder)
        if folder.name == out.name or identity is None:
            continue
        if names.isdisjoint(one.name for one in identity.submissions):
            continue
        try:
            yield folder, read_results(folder / RESULTS_FILE)
        except (UserError, OSError):
            continue  # it was not completed


def _same(earlier: Results, now: Results, on: Evaluation) -> bool:
    """Return whether two evaluations played the same matches of a track, under the same conditions."""
    same = ("versions", "suite", "seed", "commitment", "rounds", "sandbox", "clock", "model")
    if any(getattr(earlier, name) != getattr(now, name) for name in same):
        return False
    return earlier.limits.get(on.track) == now.limits.get(on.track)
