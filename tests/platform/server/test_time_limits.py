"""The clock of a seat, and how long a match may last by it."""

import pytest
from tests.platform.helpers.seats import small_spec

from wildscav_server.time_limits import MARGIN, Clock, TimeBank


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
    assert bank.allowed() == pytest.approx(0.1 + left)


@pytest.mark.parametrize(
    "wrong",
    [{"step_budget": 0.0}, {"time_bank": -1.0}, {"join_timeout": float("nan")}, {"idle_limit": 0.0}],
)
def test_a_clock_that_cannot_be_kept_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Clock(**wrong)


@pytest.mark.parametrize(
    ("elapsed", "waited", "left", "credited", "in_time"),
    [
        (0.3, 0.05, 0.85, 0.05, True),  # 0.2 s over the budget, of which it had no processor for 0.05 s
        (0.15, 0.09, 1.0, 0.05, True),  # no more is credited than it was over the budget
        (0.09, 0.08, 1.0, 0.0, True),  # within the budget nothing is paid, so nothing is credited
        (0.9, 0.7, 0.3, 0.1, True),  # nor more than the budget in one step
        (3.0, 3.0, 0.0, 0.1, False),
    ],
)
def test_the_bank_does_not_pay_for_waits(
    elapsed: float, waited: float, left: float, credited: float, in_time: bool
) -> None:
    bank = TimeBank(Clock(step_budget=0.1, time_bank=1.0))

    assert bank.charge(elapsed, waited) == in_time
    assert (bank.left, bank.credited) == (pytest.approx(left), pytest.approx(credited))


@pytest.mark.parametrize(
    ("longest", "seats", "bank", "bound"),
    [
        (None, 2, 30.0, 30 + 20 + 2 * 30),  # 200 steps of 0.1 s
        (60.0, 2, 20.0, 30 + 60),
        (60.0, 800, 0.05, 30 + 60),  # every bank is smaller alike
        (1000.0, 2, 30.0, 30 + 20 + 2 * 30),  # no bank is larger than usual
        (20.0, 2, 0.0, 30 + 20),
    ],
)
def test_the_longest_time_makes_every_bank_smaller(
    longest: float | None, seats: int, bank: float, bound: float
) -> None:
    spec = small_spec("battle", seconds=20.0, filled_by=("submission",) * seats + ("fighter",))
    clock = Clock(longest=longest)

    assert clock.fitted(spec).time_bank == pytest.approx(bank)
    assert clock.bound(spec) == clock.fitted(spec).bound(spec) == pytest.approx(bound)
    # What hangs is what is later than the bound, what may be credited besides, and a margin.
    assert clock.deadline(spec) == pytest.approx(bound + 20 + MARGIN)


def test_a_longest_time_below_the_budgets_is_refused() -> None:
    with pytest.raises(ValueError, match=r"within 19 s: the budgets of its 200 steps alone are 20 s$"):
        Clock(longest=19.0).fitted(small_spec(seconds=20.0))


def test_a_paused_clock_has_the_idle_limit_for_every_answer_and_a_bank_for_all() -> None:
    spec = small_spec(seconds=20.0, clock="paused")

    clock = Clock(idle_limit=50.0, paused_bank=70.0).fitted(spec)
    bank = clock.bank()

    assert clock.fitted(spec) == clock
    assert clock.bound(spec) == 30.0 + 200 * 0.1 + 70.0
    assert bank.allowed() == 50.0
    assert bank.charge(50.0)
    assert bank.allowed() == pytest.approx(0.1 + 70.0 - 49.9)
    assert not bank.charge(20.3)
    assert not clock.bank().charge(50.1)
