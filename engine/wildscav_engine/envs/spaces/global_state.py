"""The state of the whole match in one row, for central critics: ``state()`` of PettingZoo environments.

The first four numbers describe the match: the remaining time in s, and the position of the target (0 without
one). Fourteen numbers follow for each seat, including robots: 1 if it is still in the match; team; x, y, z in
m; velocity x, y, z in m/s; sine and cosine of its yaw; pitch in degrees; health in hp; supplies; rounds in
the weapon and spare.
"""

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import FAR, FAST, LONG, MANY
from wildscav_engine.simulation.state import NOT_ELIMINATED, Agents, State
from wildscav_engine.specs.rules import FRAME

MATCH_LOW, MATCH_HIGH = (0.0, -FAR, -FAR, -FAR), (LONG, FAR, FAR, FAR)
SEAT_LOW = (0, 0, -FAR, -FAR, -FAR, -FAST, -FAST, -FAST, -1, -1, -90, 0, 0, 0)
SEAT_HIGH = (1, 1000, FAR, FAR, FAR, FAST, FAST, FAST, 1, 1, 90, 10_000, MANY, MANY)


def global_state_space(config: EnvConfig) -> Box:
    """Return the space of ``global_state``."""
    seats = len(config.seats)
    low = np.array([*MATCH_LOW, *SEAT_LOW * seats], np.float32)
    return Box(low, np.array([*MATCH_HIGH, *SEAT_HIGH * seats], np.float32), dtype=np.float32)


def global_state(state: State) -> NDArray[np.float32]:
    """Return the row for the first match of a state."""
    agents, _, matches = state
    seats = agents.health.shape[1]
    row = np.empty(len(MATCH_LOW) + seats * len(SEAT_LOW), np.float32)
    row[0] = max(0, matches.frame_limit[0] - matches.frame[0]) * FRAME
    row[1:4] = matches.target[0]
    _write_seats(agents, row[4:].reshape(seats, -1))
    return row


@kernel
def _write_seats(agents: Agents, rows: NDArray[np.float32]) -> None:
    for seat in range(rows.shape[0]):
        row = rows[seat]
        row[0] = agents.eliminated[0, seat] == NOT_ELIMINATED
        row[1] = agents.team[0, seat]
        for axis in range(3):
            row[2 + axis] = agents.position[0, seat, axis]
            row[5 + axis] = agents.velocity[0, seat, axis]
        row[8] = max(-1.0, min(1.0, sine(agents.yaw[0, seat])))
        row[9] = max(-1.0, min(1.0, cosine(agents.yaw[0, seat])))
        row[10] = agents.pitch[0, seat]
        row[11] = agents.health[0, seat]
        row[12] = agents.supplies[0, seat]
        row[13] = agents.clip[0, seat] + agents.spare_ammo[0, seat]
