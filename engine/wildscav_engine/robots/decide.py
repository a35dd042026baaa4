"""Which robot decides for which seat."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.kernel import kernel
from wildscav_engine.robots.base import Situation
from wildscav_engine.robots.fighter import FIGHTER, fight
from wildscav_engine.robots.gatherer import GATHERER, collect
from wildscav_engine.robots.walker import WALKER, walk

ROBOTS = {robot.name: robot for robot in (WALKER, GATHERER, FIGHTER)}

_WALKER, _GATHERER, _FIGHTER = WALKER.number, GATHERER.number, FIGHTER.number


@kernel
def decide(now: Situation, action: NDArray[np.float32]) -> None:
    """Write what the robot in a seat does in the coming step; the row holds zeros before."""
    robot = now.agents.robot[now.seat]
    if robot == _WALKER:
        walk(now, action)
    elif robot == _GATHERER:
        collect(now, action)
    elif robot == _FIGHTER:
        fight(now, action)
