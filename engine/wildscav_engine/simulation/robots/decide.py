"""Which robot decides for which seat."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.extensions import Registry
from wildscav_engine.simulation.robots.base import Robot, Situation, keep_safe
from wildscav_engine.simulation.robots.fighter import FIGHTERS, fight
from wildscav_engine.simulation.robots.gatherer import GATHERERS, collect
from wildscav_engine.simulation.robots.seeker import SEEKERS, find
from wildscav_engine.simulation.robots.walker import WALKERS, walk

KINDS: Registry[tuple[Robot, ...]] = Registry("wildscav.robots")
ROBOTS = {robot.name: robot for levels in KINDS.values() for robot in levels}

_WALKER, _GATHERER, _FIGHTER, _SEEKER = (
    kind[0].number // 10 for kind in (WALKERS, GATHERERS, FIGHTERS, SEEKERS)
)


@kernel
def decide(now: Situation, action: NDArray[np.float32]) -> None:
    """Write what the robot in a seat does in the coming step; the row holds zeros before."""
    kind = now.agents.robot[now.seat] // 10
    if kind == _FIGHTER:
        fight(now, action)
    elif keep_safe(now, action):
        return
    elif kind == _WALKER:
        walk(now, action)
    elif kind == _GATHERER:
        collect(now, action)
    elif kind == _SEEKER:
        find(now, action)
