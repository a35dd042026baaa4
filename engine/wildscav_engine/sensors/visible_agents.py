"""The other agents in sight as an array: what ``agents`` of an observation lists.

Each row describes one agent, nearest first. Its columns are 1; its seat; its team; its position relative to
the agent's soles in the axes of the world (x east, y up, z north, m); its distance (m); its velocity (x, y,
z, m/s); its yaw (degrees in (-180, 180], 0 looks along +z, clockwise); its health (hp); and 1 if it is
invincible. Unused rows are 0. ``visibility.py`` decides which agents are in sight.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.batched import TableSensor
from wildscav_engine.sensors.motion import MOTION_COLUMNS, write_motion
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

# Seats and teams are numbers below 1000; rules allow 10,000 hp at most.
COLUMNS = (
    Column("present", "0 or 1", 0, 1, "whether the row describes an agent"),
    Column("seat", "", 0, 999, "its seat"),
    Column("team", "", 0, 999, "its team"),
    *MOTION_COLUMNS,
    Column("health", "hp", 0, 10_000, "its health"),
    Column("invincible", "0 or 1", 0, 1, "whether it is invincible now"),
)


@sensor
class VisibleAgents(TableSensor):
    """The nearest agents in sight."""

    name: ClassVar[str] = "visible_agents"
    title: ClassVar[str] = (
        "agents in sight: present, seat, team, position from the soles, m, distance, m, velocity, m/s, "
        "yaw, degrees, health, hp, invincible"
    )
    table: ClassVar[tuple[Column, ...]] = COLUMNS

    limit: Annotated[int, Field(ge=1, le=AGENT_LIMIT)] = AGENT_LIMIT  # rows

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 13)."""
        agents = state.agents
        readings = np.zeros((len(seen.agents), len(seats), self.limit, len(COLUMNS)), np.float32)
        _write_agents(
            *(seen.agents, seen.agent_count, agents.team, agents.position, agents.velocity, agents.yaw),
            *(agents.health, agents.invincible_left, seats, readings),
        )
        return readings


@kernel
def _write_agents(
    others: NDArray[np.int32],
    count: NDArray[np.int32],
    team: NDArray[np.int32],
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    yaw: NDArray[np.float64],
    health: NDArray[np.int32],
    invincible_left: NDArray[np.int32],
    seats: NDArray[np.int64],
    readings: NDArray[np.float32],
) -> None:
    """Write what some seats, (S,), of all matches see of other agents, into zeros (B, S, limit, columns).

    Everything else is as in ``Seen`` and ``Agents``.
    """
    for match in range(readings.shape[0]):
        for reader in range(seats.shape[0]):
            seat = seats[reader]
            for place in range(min(readings.shape[2], count[match, seat])):
                other, row = others[match, seat, place], readings[match, reader, place]
                row[0], row[1], row[2] = 1.0, other, team[match, other]
                write_motion(position[match], velocity[match], yaw[match], seat, other, row[3:11])
                row[11] = health[match, other]
                row[12] = invincible_left[match, other] > 0
