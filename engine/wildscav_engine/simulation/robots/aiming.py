"""Fighting: choosing an enemy in sight, aiming, firing and circling."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, random_in, turn_toward, walk_toward
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field
from wildscav_engine.specs.body import BODY_RADIUS, EYE_HEIGHT

AIM_HEIGHT = 1.0  # m above the enemy's soles
PITCH_ERROR = 1 / 3  # of the skill's aim error
LOW_CLIP = 5  # rounds; with fewer and no enemy in sight, it reloads
CREEP = 1.0  # m/s, its slowest walk around an enemy
CIRCLE_SIDE = 80.0  # degrees between the way around an enemy and the way to it


@kernel
def nearest_enemy(now: Situation) -> int:
    """Return the nearest enemy in sight that can be hurt, or NOBODY."""
    for place in range(now.seen.agent_count[now.seat]):
        other = now.seen.agents[now.seat, place]
        if can_hurt(now, other):
            return int(other)
    return NOBODY


@kernel
def can_hurt(now: Situation, other: int) -> bool:
    """Return whether another agent is an enemy that is not invincible."""
    enemy = now.agents.team[other] != now.agents.team[now.seat]
    return bool(enemy and now.agents.invincible_left[other] == 0)


@kernel
def reload_low_clip(now: Situation, action: NDArray[np.float32]) -> None:
    """Reload if few rounds are left; for robots without an enemy in sight."""
    if now.agents.clip[now.seat] < LOW_CLIP:
        action[Field.RELOAD] = 1.0


@kernel
def aim_and_fire(now: Situation, enemy: int, action: NDArray[np.float32]) -> float:
    """Turn towards an enemy, and fire if the aim is good enough; return its compass direction in degrees."""
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
    return float(yaw)


@kernel
def circle(now: Situation, enemy: int, yaw: float, action: NDArray[np.float32]) -> None:
    """Circle around an enemy in a compass direction, to be harder to hit, as fast as shots still hit."""
    side = CIRCLE_SIDE if (now.frame // 100 + now.seat) % 2 == 0 else -CIRCLE_SIDE
    walk_toward(now, yaw + side, _steady_speed(now, enemy), action)


@kernel
def _steady_speed(now: Situation, enemy: int) -> float:
    """Return the speed at which a robot circles, m/s: less where its walk would spread its shots too far."""
    fastest = now.skill.wander_speed
    if now.spread * now.walking_sway == 0.0:
        return fastest
    here, there = now.agents.position[now.seat], now.agents.position[enemy]
    dx, dz = there[0] - here[0], there[2] - here[2]
    half_width = arctangent(BODY_RADIUS, np.sqrt(dx * dx + dz * dz))
    sway = (now.skill.steadiness * half_width / now.spread - 1.0) / now.walking_sway
    return float(min(fastest, max(CREEP, MAX_WALK_SPEED * sway)))
