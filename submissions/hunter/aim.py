"""Aiming at an enemy, and deciding when a shot will hit."""

import math
from typing import NamedTuple

from wildscav import Observation, VisibleAgent
from wildscav.geometry import BODY_HEIGHT, BODY_RADIUS, direction_to, flat_distance, pitch_to, turn_to

Vector = tuple[float, float, float]

LEAD = 0.1  # s between an observation and the action that it leads to
MAX_TURN = 18.0  # degrees per frame; the game has no limit, but more is not needed
SCAN_TURN = 6.0  # degrees per frame: a full turn in 1.2 s
SURE_SHOT = 0.8  # of the body's half width: the largest aiming error for a shot


class Order(NamedTuple):
    """How to turn and look during a step, and whether to shoot."""

    turn: float  # degrees per frame
    look: float  # degrees per frame
    shoot: bool


def nearest_enemy(observation: Observation, team: int) -> VisibleAgent | None:
    """Return the nearest enemy in sight that can be hurt."""
    enemies = (agent for agent in observation.agents if agent.team != team and not agent.invincible)
    return next(enemies, None)


def aim_at(observation: Observation, enemy: VisibleAgent, frames: int) -> Order:
    """Turn to where an enemy will be, and shoot if it is in the sights already.

    Args:
        observation: The current observation.
        enemy: The enemy to aim at.
        frames: Frames in a step.
    """
    middle: Vector = (
        enemy.position[0] + enemy.velocity[0] * LEAD,
        enemy.position[1] + BODY_HEIGHT / 2.0,
        enemy.position[2] + enemy.velocity[2] * LEAD,
    )
    turn = turn_to(observation.yaw, direction_to(observation.position, middle))
    look = pitch_to(observation.position, middle) - observation.pitch
    way = max(flat_distance(observation.position, middle), 0.1)
    half_width = math.degrees(math.atan2(BODY_RADIUS, way)) * SURE_SHOT
    half_height = math.degrees(math.atan2(BODY_HEIGHT / 2.0, way)) * SURE_SHOT
    return Order(
        turn=_limited(turn / frames),
        look=_limited(look / frames),
        shoot=abs(turn) < half_width and abs(look) < half_height,
    )


def look_around(observation: Observation, frames: int) -> Order:
    """Keep turning with a level view; after a hit by an agent that is not in sight, turn round at once."""
    turn = 180.0 / frames if observation.hit_by_seat is not None else SCAN_TURN
    return Order(turn=turn, look=_limited(-observation.pitch / frames), shoot=False)


def _limited(turn: float) -> float:
    return max(-MAX_TURN, min(MAX_TURN, turn))
