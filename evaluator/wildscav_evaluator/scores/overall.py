"""One rating across the tracks of a suite, from scores of which ``random`` has 0 and a reference agent 1.

The mean counts all tracks alike. The interquartile mean (IQM) leaves out the best and the worst quarter of
all matches, so that a few of them do not decide (Agarwal et al., "Deep Reinforcement Learning at the Edge of
the Statistical Precipice", NeurIPS 2021). Both intervals resample the matches of each track by themselves.
"""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.output.results import Estimate, Evaluation, Overall
from wildscav_evaluator.resampling import SEED, expanded_tail
from wildscav_evaluator.scores.score import RESAMPLES
from wildscav_evaluator.suites.suite import Reference, Suite


def overall_of(suite: Suite, evaluations: Iterable[Evaluation]) -> tuple[Overall, ...] | None:
    """Return the ratings of the submissions that played all tracks of a suite; None without a scale."""
    if not suite.references:
        return None
    played: dict[tuple[str, str], dict[str, Evaluation]] = {}
    for one in evaluations:
        if one.score is not None:
            played.setdefault((one.submission, one.version), {})[one.track] = one
    return tuple(
        _overall(suite.references, on_tracks)
        for on_tracks in played.values()
        if on_tracks.keys() >= suite.references.keys()
    )


def _overall(references: Mapping[str, Reference], played: Mapping[str, Evaluation]) -> Overall:
    scores = [normalized_scores(reference, played[track]) for track, reference in references.items()]
    mean, iqm = across_tracks(scores)
    tracks = {track: _on_track(reference, played[track]) for track, reference in references.items()}
    one = next(iter(played.values()))
    return Overall(
        submission=one.submission,
        version=one.version,
        interface=one.interface,
        mean=mean,
        iqm=iqm,
        tracks=tracks,
    )


def normalized_scores(reference: Reference, played: Evaluation) -> list[float]:
    """Return the normalized score of every match that has a result."""
    score = played.metrics[0].name
    return [reference.normalized(row.metrics[score]) for row in played.matches if row.metrics is not None]


def _on_track(reference: Reference, played: Evaluation) -> Estimate:
    """Return the normalized mean, whose interval is that of the score: the scale is exact."""
    score = played.summary[played.metrics[0].name]
    low, high = sorted(map(reference.normalized, (score.low, score.high)))
    return Estimate(value=reference.normalized(score.mean), low=low, high=high)


def across_tracks(scores: Sequence[Sequence[float]]) -> tuple[Estimate, Estimate]:
    """Return the mean of the tracks' means, and the interquartile mean of all matches.

    ``scores`` are the normalized ones of each track's matches, at least one.
    """
    mean = math.fsum(math.fsum(track) / len(track) for track in scores) / len(scores)
    iqm = float(_middle(np.concatenate([np.array(track) for track in scores])[None])[0])
    fewest = min(map(len, scores))
    if fewest == 1:
        return Estimate(value=mean, low=mean, high=mean), Estimate(value=iqm, low=iqm, high=iqm)
    dice = np.random.Generator(np.random.Philox(SEED))
    drawn = [np.array(track)[dice.integers(0, len(track), size=(RESAMPLES, len(track)))] for track in scores]
    means = sum(track.sum(axis=1) / track.shape[1] for track in drawn) / len(drawn)
    tail = expanded_tail(fewest, len(scores))
    return _estimate(mean, means, tail), _estimate(iqm, _middle(np.concatenate(drawn, axis=1)), tail)


def _middle(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of the middle half of each row."""
    cut = values.shape[1] // 4
    return np.asarray(np.sort(values, axis=1)[:, cut : values.shape[1] - cut].mean(axis=1))


def _estimate(value: float, resampled: NDArray[np.float64], tail: float) -> Estimate:
    low, high = np.percentile(resampled, (100.0 * tail, 100.0 - 100.0 * tail)).tolist()
    return Estimate(value=value, low=low, high=high)
