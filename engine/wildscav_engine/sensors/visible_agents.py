"""The other agents in sight, as an array: what ``agents`` of an observation lists.

A row an agent, nearest first. Its columns are 1; its seat; its team; where it stands from the own soles in
the world's axes (x east, y up, z north, m); how far away (m); its velocity (x, y, z, m/s); its yaw (degrees
in (-180, 180], 0 looks along +z, clockwise); its health (hp); and 1 if shots do it no harm. Rows that are not
used are 0. Who is in sight is what ``visibility.py`` rules.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import Sensor, rows_of, sensor, table_space
from wildscav_engine.sensors.visibility import AGENT_LIMIT

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.match import Match

INF = np.inf
# Seats and teams are numbers below 1000; rules allow 10,000 hp at most.
LOW = (0, 0, 0, -INF, -INF, -INF, 0, -INF, -INF, -INF, -180, 0, 0)
HIGH = (1, 999, 999, INF, INF, INF, INF, INF, INF, INF, 180, 10_000, 1)


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
    def space(self) -> "Box":
        """(limit, 13)."""
        return table_space(self.limit, LOW, HIGH)

    def read(self, match: "Match", seats: Sequence[int]) -> NDArray[np.float32]:
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
        readings = np.zeros((len(rows), self.limit, len(HIGH)), np.float32)
        readings[reader, place] = np.stack(columns, axis=-1)
        return readings
