"""Whatever happens to conductors, clocks and messages: nothing is lost, nothing twice, nothing stuck."""

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test
from tests.leaderboard.conductor.stormy_season import StormySeason

pytestmark = pytest.mark.slow
STORMS = settings(
    max_examples=25, stateful_step_count=60, deadline=None, suppress_health_check=list(HealthCheck)
)


def test_a_season_survives_many_storms() -> None:
    run_state_machine_as_test(StormySeason, settings=STORMS)
