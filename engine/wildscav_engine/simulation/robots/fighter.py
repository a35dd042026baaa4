"""The fighter: it shoots at the nearest enemy in sight, and otherwise gathers supplies.

The hard one runs for cover while it reloads and when it is weak, and stays hidden for a moment.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.aiming import aim_and_fire, circle, nearest_enemy, reload_low_clip
from wildscav_engine.simulation.robots.base import (
    Situation,
    gather,
    keep_safe,
    levels_of,
    visit_hot_spot,
    wander,
)
from wildscav_engine.simulation.robots.cover import hide, leaves_fight, take_cover
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field


@kernel
def fight(now: Situation, action: NDArray[np.float32]) -> None:
    """Fight the nearest enemy in sight; else reload, and keep safe, gather, visit the hot spot or wander."""
    enemy = nearest_enemy(now)
    if enemy == NOBODY:
        reload_low_clip(now, action)
        if keep_safe(now, action) or hide(now, action) or gather(now, action) or visit_hot_spot(now, action):
            return
        wander(now, action)
        return
    yaw = aim_and_fire(now, enemy, action)
    if leaves_fight(now, enemy):
        take_cover(now, enemy, action)
    else:
        circle(now, enemy, yaw, action)
    action[Field.PICK_UP] = 1.0


FIGHTERS = levels_of("fighter", "shoots at the nearest enemy, gathers in between", fight, 3)
