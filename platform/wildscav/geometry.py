"""Geometry helpers for agents, in the game's conventions.

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
    """Return the horizontal distance, m."""
    return math.hypot(b[0] - a[0], b[2] - a[2])


def direction_to(position: Vector, target: Vector) -> float:
    """Return the compass direction to a target, degrees in [0, 360); 0 if it is directly above or below."""
    return math.degrees(math.atan2(target[0] - position[0], target[2] - position[2])) % 360.0


def turn_to(yaw: float, direction: float) -> float:
    """Return the smallest turn from a yaw to a direction, degrees in [-180, 180)."""
    return (direction - yaw + 180.0) % 360.0 - 180.0


def pitch_to(position: Vector, target: Vector, *, eye_height: float = EYE_HEIGHT) -> float:
    """Return the pitch at which the agent's eyes look at a target, degrees; positive is down.

    Args:
        position: The soles of the agent.
        target: The point to look at; for another agent, about half of ``BODY_HEIGHT`` above its soles.
        eye_height: Height of the eyes above the soles, m.
    """
    down = position[1] + eye_height - target[1]
    return math.degrees(math.atan2(down, flat_distance(position, target)))


def moved(position: Vector, direction: float, length: float) -> Vector:
    """Return the position that is a horizontal length (m) away in a compass direction."""
    angle = math.radians(direction)
    return (position[0] + length * math.sin(angle), position[1], position[2] + length * math.cos(angle))
