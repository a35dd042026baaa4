"""What thinking costs: whole steps by a stated rule, of which nothing is ever lost."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.thinking import Account, ClockChoice, ThinkingPrice, held

THOUGHTS = st.lists(st.tuples(st.integers(0, 10**7), st.integers(0, 10**13)), max_size=50)
RATES = st.integers(0, 3 * 10**9)


@given(THOUGHTS, RATES, RATES, st.integers(1, 50))
def test_the_steps_charged_are_the_whole_steps_of_all_thoughts_so_far(
    thoughts: list[tuple[int, int]], token: int, processor: int, frames: int
) -> None:
    account = Account(ThinkingPrice(token_time=token / 1e9, processor_time=processor / 1e9), frames)
    owed, charged = Fraction(0), 0
    for tokens, nanoseconds in thoughts:
        owed += tokens * Fraction(token, 10**9) + Fraction(nanoseconds, 10**9) * Fraction(processor, 10**9)
        charged += account.charge(tokens, nanoseconds)
        assert charged == owed // Fraction(frames, 50)


def test_walking_holds_and_no_press_is_repeated() -> None:
    actions = np.arange(1.0, 1.0 + 2 * FIELDS, dtype=np.float32).reshape(2, FIELDS)
    assert held(actions).tolist() == [[1.0, 2.0, *[0.0] * 6], [9.0, 10.0, *[0.0] * 6]]
    assert held(held(actions)).tobytes() == held(actions).tobytes()


def test_a_clock_says_its_price() -> None:
    assert str(ClockChoice()) == "bank"
    priced = ClockChoice.model_validate({"clock": "tokens", "thinking": {"budget": 60}})
    assert str(priced) == "tokens (0.02 s per token, 1 s per processor s, budget 60 s)"


def test_a_pace_that_would_never_end_a_step_is_refused() -> None:
    with pytest.raises(ValueError, match=r"thinking\.pace"):
        ClockChoice.model_validate({"clock": "running", "thinking": {"pace": 1e-310}})
