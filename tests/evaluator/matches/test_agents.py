"""What agents spend on thinking, as the match that charges them is told."""

import subprocess
import sys
import time

import pytest

from wildscav_evaluator.matches.agents import AgentSpending, process_time
from wildscav_server.thinking import Purse


def test_spending_counts_from_the_first_reading_and_outlives_the_agent() -> None:
    ran, tokens = [3.0], [100]
    spending = AgentSpending(lambda: tokens[0])
    assert spending.spent() == (100, 0.0)

    def processor() -> float:
        if not ran:
            raise OSError("the control group is gone")
        return ran[-1]

    spending.measure(processor)
    assert spending.spent() == (100, 0.0)
    ran.append(3.5)
    tokens[0] = 120
    assert spending.spent() == (120, 0.5)
    ran.clear()
    assert spending.spent() == (120, 0.5)


def test_a_purse_leaves_out_what_was_spent_before_the_match_and_takes_everything_once() -> None:
    total = [(7, 1.0)]
    purse = Purse()
    purse.begin()
    assert purse.take() == (0, 0)  # nothing counts
    purse.count(lambda: total[-1])
    assert purse.take() == (0, 0)
    total.append((10, 1.000000001))
    assert purse.take() == (3, 1)
    total.append((5, 0.5))  # a count that falls gives nothing back, and is not paid twice
    assert purse.take() == (0, 0)
    total.append((11, 1.000000001))
    assert purse.take() == (1, 0)
    assert (purse.tokens, purse.processor) == (4, 1)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell")
def test_the_time_of_a_process_is_that_of_its_threads() -> None:
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as busy:
        try:
            while process_time(busy.pid) < 0.05:
                time.sleep(0.005)
        finally:
            busy.kill()
    with pytest.raises(OSError, match="Invalid argument"):
        process_time(busy.pid)
