"""The teammates, as an array: each knows where the others are and how they do, in sight or not.

A row a teammate, nearest first, of equal distance the lower seat. Its columns are 1; its seat; where it
stands from the own soles in the world's axes (x east, y up, z north, m); how far away (m); its velocity (x,
y, z, m/s); its yaw (degrees in (-180, 180], 0 looks along +z, clockwise); its health (hp, 0 is dead); 1 if
shots do it no harm; and the supplies it carries. Rows that are not used are 0.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import Sensor, rows_of, sensor, table_space

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.match import Match

INF = np.inf
MOST_SUPPLIES = 2.0**31  # carried: what a 32-bit count holds
# Seats are numbers below 1000; rules allow 10,000 hp at most.
LOW = (0, 0, -INF, -INF, -INF, 0, -INF, -INF, -INF, -180, 0, 0, 0)
HIGH = (1, 999, INF, INF, INF, INF, INF, INF, INF, 180, 10_000, 1, MOST_SUPPLIES)


@sensor
class Teammates(Sensor):
    """The nearest teammates, wherever they are."""

    name: ClassVar[str] = "teammates"
    title: ClassVar[str] = (
        "teammates: present, seat, position from the soles, m, distance, m, velocity, m/s, yaw, degrees, "
        "health, hp, invincible, supplies"
    )

    limit: Annotated[int, Field(ge=1, le=64)] = 7  # rows

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
        readings = np.zeros((len(rows), self.limit, len(HIGH)), np.float32)
        for reading, row in zip(readings, rows, strict=True):
            mates = self._nearest(match, int(row))
            reading[: len(mates)] = _describe(match, int(row), mates)
        return readings

    def _nearest(self, match: "Match", row: int) -> NDArray[np.int64]:
        """Return the seats of the nearest teammates, nearest first."""
        agents = match.state.agents
        mates = np.flatnonzero(agents.team[0, : match.seats] == agents.team[0, row])
        mates = mates[mates != row]
        ways = agents.position[0, mates] - agents.position[0, row]
        order = np.argsort((ways * ways).sum(axis=1), kind="stable")
        nearest: NDArray[np.int64] = mates[order[: self.limit]]
        return nearest


def _describe(match: "Match", row: int, mates: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return (len(mates), 13) what a seat knows of some teammates."""
    agents = match.state.agents
    x, y, z = (agents.position[0, mates] - agents.position[0, row]).T
    return np.stack(
        (
            *(np.ones(len(mates)), mates, x, y, z, np.sqrt(x * x + y * y + z * z)),
            *agents.velocity[0, mates].T,
            *(agents.yaw[0, mates], agents.health[0, mates], agents.invincible_left[0, mates] > 0),
            agents.supplies[0, mates],
        ),
        axis=-1,
    )
