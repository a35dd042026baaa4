"""The way of an agent to a place, as networks can use it: relative to the agent's yaw."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, logarithm, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.state import Agents


@kernel
def write_way(agents: Agents, match: int, seat: int, x: float, z: float, row: NDArray[np.float32]) -> None:
    """Write (4,) the way to a place: 1; right of the yaw and along it, of 1; ln(1 + distance / m)."""
    east, north = x - agents.position[match, seat, 0], z - agents.position[match, seat, 2]
    distance = write_direction(east, north, agents.yaw[match, seat], row[1:3])
    row[0], row[3] = 1.0, logarithm(1.0 + distance)


@kernel
def write_direction(east: float, north: float, yaw: float, row: NDArray[np.float32]) -> float:
    """Write (2,) a level way's parts to the right of a yaw and along it, of 1, and return its length in m."""
    distance = np.sqrt(east * east + north * north)
    if distance > 0.0:
        row[0] = max(-1.0, min(1.0, (east * cosine(yaw) - north * sine(yaw)) / distance))
        row[1] = max(-1.0, min(1.0, (east * sine(yaw) + north * cosine(yaw)) / distance))
    return float(distance)
