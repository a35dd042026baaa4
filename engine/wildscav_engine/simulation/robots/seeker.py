"""The seeker: it searches for the target, walks there once it is known, and picks up boxes on the way.

The hard one searches square after square and feels its way around obstacles; the others wander about until
they know the target, and try detours in any direction.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Memory, Situation, go_to, keep_safe, levels_of, wander
from wildscav_engine.simulation.robots.search import (
    Search,
    feel_way_to,
    forget_obstacle,
    search,
    stop_search,
)
from wildscav_engine.specs.actions import Field

LOST = 8.0  # detours around one obstacle after which it tries from elsewhere
AWAY = 40.0  # steps for which it wanders away from there


@kernel
def find(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else go to the target, else wander."""
    if keep_safe(now, action):
        return
    action[Field.PICK_UP] = 1.0
    if now.skill.follows_obstacles:
        _seek_well(now, action)
    elif not _seek(now, action):
        wander(now, action)


@kernel
def _seek_well(now: Situation, action: NDArray[np.float32]) -> None:
    """Search for the target, or feel the way to it; where that leads nowhere, try again from elsewhere."""
    memory, target = now.agents.memory[now.seat], now.matches.target[now.match]
    if not now.agents.knows_target[now.seat]:
        search(now, action)
        return
    stop_search(now)
    if memory[Memory.DETOURS] >= LOST:
        memory[Search.AWAY_LEFT] = AWAY
        forget_obstacle(memory)
    if memory[Search.AWAY_LEFT] > 0.0:
        memory[Search.AWAY_LEFT] -= 1.0
        wander(now, action)
        return
    feel_way_to(now, target[0], target[2], action)


@kernel
def _seek(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to the target; return False if there is none or the robot does not know it."""
    if not now.agents.knows_target[now.seat]:
        return False
    target = now.matches.target[now.match]
    go_to(now, target[0], target[2], action)
    return True


SEEKERS = levels_of("seeker", "looks for the target and goes there", find, 4)
