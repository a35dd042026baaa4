"""The fighter: it shoots at the nearest enemy in sight, and otherwise gathers supplies."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import (
    Situation,
    gather,
    keep_safe,
    levels_of,
    random_in,
    turn_toward,
    visit_hot_spot,
    walk_toward,
    wander,
)
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import EYE_HEIGHT

AIM_HEIGHT = 1.0  # m above the enemy's soles
PITCH_ERROR = 1 / 3  # of the skill's aim error
LOW_CLIP = 5  # rounds; with fewer and no enemy in sight, it reloads


@kernel
def fight(now: Situation, action: NDArray[np.float32]) -> None:
    """Fight the nearest enemy in sight; else reload, and keep safe, gather, visit the hot spot or wander."""
    enemy = nearest_enemy(now)
    if enemy == NOBODY:
        if now.agents.clip[now.seat] < LOW_CLIP:
            action[Field.RELOAD] = 1.0
        if keep_safe(now, action) or gather(now, action) or visit_hot_spot(now, action):
            return
        wander(now, action)
        return
    _aim_and_fire(now, enemy, action)
    action[Field.PICK_UP] = 1.0


@kernel
def nearest_enemy(now: Situation) -> int:
    """Return the nearest enemy in sight that can be hurt, or NOBODY."""
    for place in range(now.seen.agent_count[now.seat]):
        other = now.seen.agents[now.seat, place]
        enemy = now.agents.team[other] != now.agents.team[now.seat]
        if enemy and now.agents.invincible_left[other] == 0:
            return int(other)
    return NOBODY


@kernel
def _aim_and_fire(now: Situation, enemy: int, action: NDArray[np.float32]) -> None:
    here, there = now.agents.position[now.seat], now.agents.position[enemy]
    own, velocity = now.agents.velocity[now.seat], now.agents.velocity[enemy]
    dx = there[0] - here[0] + (velocity[0] - own[0]) * now.skill.foresight
    dz = there[2] - here[2] + (velocity[2] - own[2]) * now.skill.foresight
    drop = here[1] + EYE_HEIGHT - there[1] - AIM_HEIGHT
    yaw = arctangent(dx, dz)
    pitch = arctangent(drop, np.sqrt(dx * dx + dz * dz))
    off = abs(wrap(yaw - now.agents.yaw[now.seat]))
    error = now.skill.aim_error
    error_yaw, error_pitch = random_in(now, -error, error, 4), random_in(now, -error, error, 5) * PITCH_ERROR
    turn_toward(now, yaw + error_yaw, pitch + error_pitch, now.skill.turn_limit, action)
    if now.agents.clip[now.seat] == 0:
        action[Field.RELOAD] = 1.0
    elif off < now.skill.aimed:
        action[Field.SHOOT] = 1.0
    # It circles around the enemy, so that it is harder to hit.
    side = 80.0 if (now.frame // 100 + now.seat) % 2 == 0 else -80.0
    walk_toward(now, yaw + side, now.skill.wander_speed, action)


FIGHTERS = levels_of("fighter", "shoots at the nearest enemy, gathers in between", fight, 3)
