"""Turning to an enemy, and knowing when a shot will hit."""

import math
from typing import NamedTuple

from wildscav import Observation, VisibleAgent
from wildscav.geometry import BODY_HEIGHT, BODY_RADIUS, direction_to, flat_distance, pitch_to, turn_to

Vector = tuple[float, float, float]

LEAD = 0.1  # s, an order acts on what was seen this long ago
MAX_TURN = 18.0  # degrees a frame; the game sets no limit, but nobody needs more
SCAN_TURN = 6.0  # degrees a frame: once around in 1.2 s
SURE_SHOT = 0.8  # of the body's half width: how far off the middle is still worth a round


class Order(NamedTuple):
    """How to turn and look during a step, and whether to shoot."""

    turn: float  # degrees a frame
    look: float  # degrees a frame
    shoot: bool


def nearest_enemy(observation: Observation, team: int) -> VisibleAgent | None:
    """Return the nearest agent in sight that can be hurt and is no friend."""
    enemies = (agent for agent in observation.agents if agent.team != team and not agent.invincible)
    return next(enemies, None)


def aim_at(observation: Observation, enemy: VisibleAgent, frames: int) -> Order:
    """Turn to where an enemy will be; shoot if the sight is on it already.

    Args:
        observation: What is seen now.
        enemy: Whom to aim at.
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
    """Turn on and on, level; after a hit from someone unseen, turn about at once."""
    turn = 180.0 / frames if observation.hit_by_seat is not None else SCAN_TURN
    return Order(turn=turn, look=_limited(-observation.pitch / frames), shoot=False)


def _limited(turn: float) -> float:
    return max(-MAX_TURN, min(MAX_TURN, turn))
