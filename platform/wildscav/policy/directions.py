"""The way to something, as environments of version 1 observe it."""

import math

from wildscav.agent import Observation, Vector
from wildscav.policy.elementary_functions import cosine, exponential, logarithm, sine

NEAR = 5.0  # m, at which the nearness has fallen to 1 / e
COLUMNS = ("known", "east", "up", "north", "right", "ahead", "above the view", "nearness", "log distance")


def direction(seen: Observation, place: Vector | None) -> tuple[float, ...]:
    """Return the way from the agent's soles to a place by ``COLUMNS``; all 0 if it is not known."""
    if place is None:
        return (0.0,) * len(COLUMNS)
    east, up, north = (there - here for there, here in zip(place, seen.position, strict=True))
    distance = math.sqrt(east * east + up * up + north * north)
    far = exponential(-distance / NEAR), logarithm(1.0 + distance)
    if distance == 0.0:
        return (1.0, *(0.0,) * 6, *far)
    east, up, north = east / distance, up / distance, north / distance
    level = math.sqrt(east * east + north * north)
    shares = (
        *(east, up, north),
        east * cosine(seen.yaw) - north * sine(seen.yaw),
        east * sine(seen.yaw) + north * cosine(seen.yaw),
        up * cosine(seen.pitch) + level * sine(seen.pitch),
    )
    return (1.0, *(max(-1.0, min(1.0, share)) for share in shares), *far)
