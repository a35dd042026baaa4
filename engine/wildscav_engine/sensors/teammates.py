"""The teammates as an array: agents know the position and condition of their teammates, in sight or not.

Each row describes one teammate, nearest first; at equal distance, the lower seat comes first. Its columns are
1; its seat; its position relative to the agent's soles in the axes of the world (x east, y up, z north, m);
its distance (m); its velocity (x, y, z, m/s); its yaw (degrees in (-180, 180], 0 looks along +z, clockwise);
its health (hp, 0 if dead); 1 if it is invincible; and the supplies that it carries. Unused rows are 0.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import MOTION_COLUMNS, Column, Sensor, rows_of, sensor, table_space

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView

MAX_SUPPLIES = 2.0**31  # carried: the bound of a 32-bit count
# Seats are numbers below 1000; rules allow 10,000 hp at most.
COLUMNS = (
    Column("present", "0 or 1", 0, 1, "whether the row describes a teammate"),
    Column("seat", "", 0, 999, "its seat"),
    *MOTION_COLUMNS,
    Column("health", "hp", 0, 10_000, "its health; 0 if it is dead"),
    Column("invincible", "0 or 1", 0, 1, "whether it is invincible now"),
    Column("supplies", "", 0, MAX_SUPPLIES, "supplies that it carries"),
)


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
        readings = np.zeros((len(rows), self.limit, len(COLUMNS)), np.float32)
        for reading, row in zip(readings, rows, strict=True):
            mates = self._nearest(match, int(row))
            reading[: len(mates)] = _describe(match, int(row), mates)
        return readings

    def _nearest(self, match: "MatchView", row: int) -> NDArray[np.int64]:
        """Return the seats of the nearest teammates, nearest first."""
        agents = match.state.agents
        mates = np.flatnonzero(agents.team[0, : match.seats] == agents.team[0, row])
        mates = mates[mates != row]
        offsets = agents.position[0, mates] - agents.position[0, row]
        order = np.argsort((offsets * offsets).sum(axis=1), kind="stable")
        nearest: NDArray[np.int64] = mates[order[: self.limit]]
        return nearest


def _describe(match: "MatchView", row: int, mates: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return (len(mates), 13) what a seat knows about some teammates."""
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
