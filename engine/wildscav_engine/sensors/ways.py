"""The ways of an agent to places, as networks can use them: relative to the agent's yaw."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, logarithm, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.state import Agents
from wildscav_engine.simulation.systems.hot_spot import latest_of
from wildscav_engine.specs.rules import FRAME


@kernel
def write_way(agents: Agents, match: int, seat: int, x: float, z: float, row: NDArray[np.float32]) -> None:
    """Write (4,) the way to a place: 1; right of the yaw and along it, of 1; ln(1 + distance / m)."""
    east, north = x - agents.position[match, seat, 0], z - agents.position[match, seat, 2]
    distance = write_direction(east, north, agents.yaw[match, seat], row[1:3])
    row[0], row[3] = 1.0, logarithm(1.0 + distance)


@kernel
def write_ways(
    agents: Agents,
    match: int,
    seat: int,
    frame: int,
    places: NDArray[np.float64],
    count: int,
    row: NDArray[np.float32],
) -> None:
    """Write (9,) the ways to the latest of some places and to the next one, and the s until that comes.

    Args:
        agents: The agents.
        match: Of the agent.
        seat: Of the agent.
        frame: The frames played.
        places: (N, 3) the frame in which each comes, in ascending order, and its x and z in m.
        count: How many of them there are.
        row: Zeros, written; what is not known stays 0.
    """
    latest = latest_of(places, count, frame)
    if latest >= 0:
        write_way(agents, match, seat, places[latest, 1], places[latest, 2], row[:4])
    following = latest + 1
    if following < count:
        write_way(agents, match, seat, places[following, 1], places[following, 2], row[4:8])
        row[8] = (places[following, 0] - frame) * FRAME


@kernel
def write_direction(east: float, north: float, yaw: float, row: NDArray[np.float32]) -> float:
    """Write (2,) a level way's parts to the right of a yaw and along it, of 1, and return its length in m."""
    distance = np.sqrt(east * east + north * north)
    if distance > 0.0:
        row[0] = max(-1.0, min(1.0, (east * cosine(yaw) - north * sine(yaw)) / distance))
        row[1] = max(-1.0, min(1.0, (east * sine(yaw) + north * cosine(yaw)) / distance))
    return float(distance)
