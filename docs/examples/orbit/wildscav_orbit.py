"""The orbiter walks in circles."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, keep_safe, levels_of, walk_toward
from wildscav_engine.specs.actions import Field

TURN = 2.0  # degrees a frame


@kernel
def orbit(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else walk ahead and turn."""
    if not keep_safe(now, action):
        walk_toward(now, now.agents.yaw[now.seat], now.skill.wander_speed, action)
        action[Field.TURN] = TURN


ORBITERS = levels_of("orbiter", "walks in circles", orbit)
