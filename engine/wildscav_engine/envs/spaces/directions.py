"""Kernels that write the way to something for learners: a direction, and distances where near matters.

Offsets in metres along the axes of the world hide both from a network: it would have to divide by the
distance to get the direction, and to turn the direction by the yaw to know where to walk.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, exponential, logarithm, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.state import Agents, Matches, Supplies
from wildscav_engine.simulation.systems.visibility import Seen

NEAR = 5.0  # m, at which the nearness has fallen to 1 / e
WIDTH = 9  # columns of a direction

Row = NDArray[np.float32]


@kernel
def write_to_target(agents: Agents, matches: Matches, match: int, seat: int, row: Row) -> None:
    """Write (WIDTH,) the way to the target; all 0 while the learner does not know it."""
    row[:] = 0.0
    if agents.knows_target[match, seat]:
        target = matches.target[match]
        _write_direction(agents, match, seat, target[0], target[1], target[2], row)


@kernel
def write_to_box(agents: Agents, supplies: Supplies, seen: Seen, match: int, seat: int, row: Row) -> None:
    """Write (WIDTH,) the way to the nearest supply box; all 0 if none is in sight."""
    row[:] = 0.0
    if seen.supply_count[match, seat] > 0:
        box = supplies.position[match, seen.supplies[match, seat, 0]]
        _write_direction(agents, match, seat, float(box[0]), float(box[1]), float(box[2]), row)


@kernel
def write_to_enemy(agents: Agents, seen: Seen, match: int, seat: int, row: Row) -> None:
    """Write (WIDTH,) the way to the nearest agent of another team; all 0 if none is in sight."""
    row[:] = 0.0
    for place in range(seen.agent_count[match, seat]):
        other = seen.agents[match, seat, place]
        if agents.team[match, other] != agents.team[match, seat]:
            soles = agents.position[match, other]
            _write_direction(agents, match, seat, soles[0], soles[1], soles[2], row)
            return


@kernel
def _write_direction(agents: Agents, match: int, seat: int, x: float, y: float, z: float, row: Row) -> None:
    """Write the way from the soles of a seat to a place; no direction if it is there."""
    own = agents.position[match, seat]
    east, up, north = x - own[0], y - own[1], z - own[2]
    distance = np.sqrt(east * east + up * up + north * north)
    row[0] = 1.0
    if distance > 0.0:
        east, up, north = east / distance, up / distance, north / distance
        yaw, pitch = agents.yaw[match, seat], agents.pitch[match, seat]
        row[1], row[2], row[3] = _share(east), _share(up), _share(north)
        row[4] = _share(east * cosine(yaw) - north * sine(yaw))
        row[5] = _share(east * sine(yaw) + north * cosine(yaw))
        level = np.sqrt(east * east + north * north)
        # The sum of the elevation and the pitch, which grows downwards.
        row[6] = _share(up * cosine(pitch) + level * sine(pitch))
    row[7] = exponential(-distance / NEAR)
    row[8] = logarithm(1.0 + distance)


@kernel
def _share(value: float) -> float:
    return max(-1.0, min(1.0, value))
