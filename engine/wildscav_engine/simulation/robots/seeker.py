"""The seeker: it searches for the target, walks there once it is known, and picks up boxes on the way.

The hard one feels its way around obstacles; the others try detours in any direction.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, go_to, keep_safe, levels_of, wander
from wildscav_engine.simulation.robots.obstacles import feel_way_to
from wildscav_engine.specs.actions import Field


@kernel
def find(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else go to the target, else wander."""
    if keep_safe(now, action):
        return
    action[Field.PICK_UP] = 1.0
    if not _seek(now, action):
        wander(now, action)


@kernel
def _seek(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to the target; return False if there is none or the robot does not know it."""
    if not now.agents.knows_target[now.seat]:
        return False
    target = now.matches.target[now.match]
    if now.skill.follows_obstacles:
        feel_way_to(now, target[0], target[2], action)
    else:
        go_to(now, target[0], target[2], action)
    return True


SEEKERS = levels_of("seeker", "looks for the target and goes there", find, 4)
