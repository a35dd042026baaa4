"""How wide the intervals of resampling are."""

import numpy as np
import pytest

from wildscav_evaluator.resampling import expanded_tail, student_quantile


def test_intervals_of_few_values_are_wider() -> None:
    # Student's quantile with 9 degrees of freedom is 2.262, times √(10 / 9).
    assert student_quantile(np.array([10, 10_000]), 0.05).tolist() == pytest.approx([2.385, 1.960], abs=1e-3)


def test_the_tails_of_few_values_are_smaller_than_2_5_percent() -> None:
    assert expanded_tail(3) == 0.0
    assert expanded_tail(10) == pytest.approx(0.0086, abs=1e-4)  # of a normal distribution, beyond 2.385
    assert expanded_tail(10_000) == pytest.approx(0.025, abs=1e-4)
