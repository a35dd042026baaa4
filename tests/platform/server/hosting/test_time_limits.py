"""The clock of a seat."""

import pytest

from wildscav.server import Clock
from wildscav.server.hosting.time_limits import TimeBank


@pytest.mark.parametrize(
    ("answers", "left", "late"),
    [
        ([0.1, 0.1], 1.0, []),  # within the budget nothing is paid
        ([0.3], 0.8, []),  # only what is over it
        ([0.6, 0.6], 0.0, []),  # to the last bit
        ([1.2], 0.0, [0]),  # too late: all that is left is taken
        ([1.2, 0.1, 0.11], 0.0, [0, 2]),  # then there is only the budget
    ],
)
def test_time_beyond_the_budget_comes_from_the_bank(
    answers: list[float], left: float, late: list[int]
) -> None:
    bank = TimeBank(Clock(step_budget=0.1, time_bank=1.0))

    in_time = [bank.charge(elapsed) for elapsed in answers]

    assert bank.left == pytest.approx(left)
    assert [step for step, fine in enumerate(in_time) if not fine] == late
    assert bank.used_up == bool(late)
    assert bank.allowed == pytest.approx(0.1 + left)


@pytest.mark.parametrize(
    "wrong",
    [{"step_budget": 0.0}, {"time_bank": -1.0}, {"join_timeout": float("nan")}, {"game_time_factor": 0}],
)
def test_a_clock_that_cannot_be_kept_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Clock(**wrong)
