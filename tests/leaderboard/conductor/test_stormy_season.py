"""Whatever happens to conductors, clocks and messages: nothing is lost, nothing twice, nothing stuck."""

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test
from tests.leaderboard.conductor.stormy_season import StormySeason

QUICK = settings(
    max_examples=4, stateful_step_count=30, deadline=None, suppress_health_check=list(HealthCheck)
)
THOROUGH = settings(QUICK, max_examples=25, stateful_step_count=60)


def test_a_season_survives_some_storms() -> None:
    run_state_machine_as_test(StormySeason, settings=QUICK)


@pytest.mark.slow
def test_a_season_survives_many_storms() -> None:
    run_state_machine_as_test(StormySeason, settings=THOROUGH)
