"""Sensors that read a whole batch at once read each match as if it were alone."""

from typing import Any

import numpy as np
import pytest
from tests.engine.envs.common import OPEN

from wildscav_engine.envs import BatchedArena
from wildscav_engine.sensors import SENSORS
from wildscav_engine.sensors.base import StateSensor

NUMBERS = [name for name, kind in SENSORS.items() if issubclass(kind, StateSensor)]
LISTS = ("visible_agents", "teammates", "nearby_supplies", "sights", "to_supplies")
CASES = [(name, {}) for name in NUMBERS] + [(name, {"limit": 1}) for name in LISTS]


@pytest.mark.parametrize(("name", "options"), CASES)
def test_a_match_reads_the_same_alone_and_in_a_batch(name: str, options: dict[str, Any]) -> None:
    arena = BatchedArena(
        "battle", 3, agents=5, teams=(0, 1, 0, 0, 1), map=OPEN, sensors={}, action_mode="multidiscrete"
    )
    arena.reset(seed=2)
    arena.action_space.seed(0)
    sensor: Any = SENSORS[name](**options)
    seats = np.array([3, 0, 4])
    found = []
    for _ in range(20):
        arena.step(arena.action_space.sample())
        batch: Any = arena.arena.batch
        together = sensor.read_batch(batch.state, batch.seen, seats)
        alone = [sensor.read(arena.arena.view(match), seats.tolist()) for match in range(3)]
        assert together.shape == (3, 3, *sensor.space.shape)
        assert together.tobytes() == np.stack(alone).tobytes()
        found.append(together)
    read = np.any(found, axis=(0, *range(3, together.ndim + 1)))
    if name in LISTS:
        assert read.any() if name == "sights" else read.all()  # some seats see teammates alone
