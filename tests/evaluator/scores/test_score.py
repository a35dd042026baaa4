"""What matches say about a submission, and how sure that is."""

import numpy as np
import pytest

from wildscav_evaluator.output.results import MatchRow, MetricInfo, metric_infos
from wildscav_evaluator.resampling import expanded_tail, student_quantile
from wildscav_evaluator.scores.number_format import number
from wildscav_evaluator.scores.score import summarize, summary


@pytest.mark.parametrize(
    ("values", "mean", "std", "low", "high", "within"),
    [
        ([3.0], 3.0, None, 3.0, 3.0, 0.0),  # a single match has no deviation and no width
        ([1.0, 5.0, 9.0], 5.0, 4.0, 1.0, 9.0, 0.0),  # the interval of a few is as wide as they lie apart
        ([2.0, 4.0, 4.0, 6.0], 4.0, (8 / 3) ** 0.5, 2.0, 6.0, 0.5),
        # Where normal theory holds: the standard error is 29.01 / sqrt(100), so 49.5 ± 1.96 · 2.9.
        ([float(value) for value in range(100)], 49.5, 29.01, 43.8, 55.2, 0.5),
    ],
)
def test_summaries(
    values: list[float], mean: float, std: float | None, low: float, high: float, within: float
) -> None:
    result = summarize(values)

    assert (result.mean, result.std) == (mean, std if std is None else pytest.approx(std, abs=0.005))
    assert (result.low, result.high) == pytest.approx((low, high), rel=0.0, abs=within)
    assert summarize(values) == result


def test_the_interval_holds_the_mean_and_narrows_with_more_matches() -> None:
    few, many = summarize([1.0, 2.0, 3.0, 4.0]), summarize([1.0, 2.0, 3.0, 4.0] * 25)

    assert few.low < few.mean < few.high
    assert many.high - many.low < (few.high - few.low) / 3


def test_nineteen_of_twenty_intervals_hold_the_true_mean() -> None:
    dice = np.random.default_rng(1)

    for count in (10, 30):
        samples = dice.exponential(1.0, size=(400, count))  # as skewed as scores come
        held = [result.low <= 1.0 <= result.high for result in map(summarize, samples.tolist())]

        assert np.mean(held) > 0.88


def test_a_match_that_never_came_to_a_result_is_left_out_and_an_agents_failure_counts() -> None:
    metric = MetricInfo(name="supplies", title="supplies", unit="", lower_is_better=False)
    rows = [
        MatchRow(index=0, status="finished", metrics={"supplies": 10.0}),
        MatchRow(index=1, status="crashed", fault="agent", metrics={"supplies": 0.0}),
        MatchRow(index=2, status="failed", fault="platform"),
    ]

    assert summary([metric], rows)["supplies"].mean == 5.0
    assert summary([metric], rows[2:]) == {}


def test_a_metric_that_results_of_an_older_version_lack_is_left_out() -> None:
    infos = metric_infos("navigation")
    rows = [MatchRow(index=0, status="finished", metrics={"time": 7.0, "success": 1.0})]

    assert set(summary(infos, rows)) == {"time", "success"}


def test_spl_is_described_beside_the_success_rate_and_shown_as_percent() -> None:
    *_, success, spl = metric_infos("navigation")

    assert (success.name, spl.name, spl.title, spl.lower_is_better) == ("success", "spl", "SPL", False)
    assert number(0.853, spl) == "85%"


def test_intervals_of_few_values_are_wider() -> None:
    # Student's quantile with 9 degrees of freedom is 2.262, times √(10 / 9).
    assert student_quantile(np.array([10, 10_000]), 0.05).tolist() == pytest.approx([2.385, 1.960], abs=1e-3)


def test_the_tails_of_few_values_are_smaller_than_2_5_percent() -> None:
    assert expanded_tail(3) == 0.0
    assert expanded_tail(10) == pytest.approx(0.0086, abs=1e-4)  # of a normal distribution, beyond 2.385
    assert expanded_tail(10_000) == pytest.approx(0.025, abs=1e-4)
