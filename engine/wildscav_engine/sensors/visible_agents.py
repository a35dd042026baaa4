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

from wildscav_engine.sensors.base import MOTION_COLUMNS, Column, sensor, table_space
from wildscav_engine.sensors.batched import BatchedSensor
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT

if TYPE_CHECKING:
    from gymnasium.spaces import Box

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
class VisibleAgents(BatchedSensor):
    """The nearest agents in sight."""

    name: ClassVar[str] = "visible_agents"
    title: ClassVar[str] = (
        "agents in sight: present, seat, team, position from the soles, m, distance, m, velocity, m/s, "
        "yaw, degrees, health, hp, invincible"
    )

    limit: Annotated[int, Field(ge=1, le=AGENT_LIMIT)] = AGENT_LIMIT  # rows

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row."""
        return COLUMNS

    @property
    def space(self) -> "Box":
        """(limit, 13)."""
        return table_space(self.limit, COLUMNS)

    def read_batch(self, state: "State", seen: "Seen", seats: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 13)."""
        agents = state.agents
        match, reader, place = np.nonzero(np.arange(self.limit) < seen.agent_count[:, seats, None])
        others, own = seen.agents[match, seats[reader], place], seats[reader]
        x, y, z = (agents.position[match, others] - agents.position[match, own]).T
        columns = (
            *(np.ones(len(others)), others, agents.team[match, others]),
            *(x, y, z, np.sqrt(x * x + y * y + z * z)),
            *agents.velocity[match, others].T,
            *(agents.yaw[match, others], agents.health[match, others]),
            agents.invincible_left[match, others] > 0,
        )
        readings = np.zeros((len(seen.agents), len(seats), self.limit, len(COLUMNS)), np.float32)
        readings[match, reader, place] = np.stack(columns, axis=-1)
        return readings
