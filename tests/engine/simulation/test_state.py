"""How much memory a match takes beside its map."""

import pytest

from wildscav_engine.simulation.state import allocate_state
from wildscav_engine.simulation.systems.visibility import allocate_seen


@pytest.mark.parametrize(("seats", "slots"), [(1, 0), (10, 400), (100, 2000), (1000, 10_000)])
def test_a_match_takes_20_kb_and_2_kb_an_agent_and_32_b_a_box(seats: int, slots: int) -> None:
    state = allocate_state(1, seats, slots, phases=16, places=10)
    parts = (*state.agents, *state.supplies, *state.matches, *allocate_seen(1, seats))
    assert sum(array.nbytes for array in parts) <= 20_000 + 2_000 * seats + 32 * slots
