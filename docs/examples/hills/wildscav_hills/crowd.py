"""The crowd: how many other agents the agent sees within some distance."""

from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import Column, Sensor, row_space, rows_of, sensor
from wildscav_engine.simulation.match_view import MatchView

COLUMNS = (Column("agents", "", 0, 1000, "other agents in sight within the radius"),)


@sensor
class Crowd(Sensor):
    """Counts the agents in sight."""

    name: ClassVar[str] = "crowd"
    title: ClassVar[str] = "how many other agents are in sight within the radius"

    radius: Annotated[float, Field(gt=0, le=1000)] = 50.0  # m

    @property
    def columns(self) -> tuple[Column, ...]:
        """The column of a reading."""
        return COLUMNS

    @property
    def space(self) -> Box:
        """(1,)."""
        return row_space(COLUMNS)

    def read(self, match: MatchView, seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), 1)."""
        agents, seen = match.state.agents, match.seen
        readings = np.zeros((len(seats), 1), np.float32)
        for row, seat in enumerate(rows_of(match, seats)):
            others = seen.agents[0, seat, : seen.agent_count[0, seat]]
            ways = agents.position[0, others] - agents.position[0, seat]
            readings[row, 0] = np.count_nonzero((ways**2).sum(axis=1) < self.radius**2)
        return readings
