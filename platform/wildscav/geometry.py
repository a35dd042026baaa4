"""Small geometry for agents, in the game's conventions.

Directions are compass degrees: 0 is north (+z), 90 is east (+x). Turns are positive to the right, pitches
positive downwards. Positions are (x, y, z) in m.
"""

import math

from wildscav.agent import Vector

EYE_HEIGHT = 1.5  # m, of the camera and the muzzle above the soles
BODY_HEIGHT = 1.78  # m
BODY_RADIUS = 0.45  # m


def distance(a: Vector, b: Vector) -> float:
    """Return the straight distance, m."""
    return math.dist(a, b)


def flat_distance(a: Vector, b: Vector) -> float:
    """Return the distance as seen from above, m."""
    return math.hypot(b[0] - a[0], b[2] - a[2])


def direction_to(position: Vector, target: Vector) -> float:
    """Return the compass direction to a target, degrees in [0, 360); 0 if it is right above or below."""
    return math.degrees(math.atan2(target[0] - position[0], target[2] - position[2])) % 360.0


def turn_to(yaw: float, direction: float) -> float:
    """Return how far to turn from a yaw to face a direction the short way, degrees in [-180, 180)."""
    return (direction - yaw + 180.0) % 360.0 - 180.0


def pitch_to(position: Vector, target: Vector, *, eye_height: float = EYE_HEIGHT) -> float:
    """Return the pitch at which the agent's eyes look at a target, degrees; positive is down.

    Args:
        position: The soles of the agent.
        target: The point to look at: of another agent, the soles plus about half the ``BODY_HEIGHT``.
        eye_height: m above the soles.
    """
    down = position[1] + eye_height - target[1]
    return math.degrees(math.atan2(down, flat_distance(position, target)))


def moved(position: Vector, direction: float, way: float) -> Vector:
    """Return the position that lies a level way (m) off in a compass direction."""
    angle = math.radians(direction)
    return (position[0] + way * math.sin(angle), position[1], position[2] + way * math.cos(angle))
