"""The other agents in sight as an array: what ``agents`` of an observation lists.

Each row describes one agent, nearest first. Its columns are 1; its seat; its team; its position relative to
the agent's soles in the axes of the world (x east, y up, z north, m); its distance (m); its velocity (x, y,
z, m/s); its yaw (degrees in (-180, 180], 0 looks along +z, clockwise); its health (hp); and 1 if it is
invincible. Unused rows are 0. ``visibility.py`` decides which agents are in sight.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import MOTION_COLUMNS, Column, Sensor, rows_of, sensor, table_space
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView

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
class VisibleAgents(Sensor):
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

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), limit, 13).

        Raises:
            ValueError: The match has no such seat.
        """
        rows = rows_of(match, seats)
        seen, agents = match.seen, match.state.agents
        reader, place = np.nonzero(np.arange(self.limit) < seen.agent_count[0, rows, None])
        others = seen.agents[0, rows[reader], place]
        x, y, z = (agents.position[0, others] - agents.position[0, rows[reader]]).T
        columns = (
            *(np.ones(len(others)), others, agents.team[0, others]),
            *(x, y, z, np.sqrt(x * x + y * y + z * z)),
            *agents.velocity[0, others].T,
            *(agents.yaw[0, others], agents.health[0, others], agents.invincible_left[0, others] > 0),
        )
        readings = np.zeros((len(rows), self.limit, len(COLUMNS)), np.float32)
        readings[reader, place] = np.stack(columns, axis=-1)
        return readings
