"""The teammates as an array: agents know the position and condition of their teammates, in sight or not.

Each row describes one teammate, nearest first; at equal distance, the lower seat comes first. Its columns are
1; its seat; its position relative to the agent's soles in the axes of the world (x east, y up, z north, m);
its distance (m); its velocity (x, y, z, m/s); its yaw (degrees in (-180, 180], 0 looks along +z, clockwise);
its health (hp, 0 if dead); 1 if it is invincible; and the supplies that it carries. Unused rows are 0.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import MOTION_COLUMNS, Column, sensor, table_space
from wildscav_engine.sensors.batched import BatchedSensor

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

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
class Teammates(BatchedSensor):
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

    def read_batch(
        self,
        state: "State",
        seen: "Seen",  # noqa: ARG002
        seats: NDArray[np.int64],
    ) -> NDArray[np.float32]:
        """Return (B, len(seats), limit, 13)."""
        agents = state.agents
        order, counts = self._nearest(state, seats)
        match, reader, place = np.nonzero(np.arange(self.limit) < counts[..., None])
        mates, own = order[match, reader, place], seats[reader]
        x, y, z = (agents.position[match, mates] - agents.position[match, own]).T
        columns = (
            *(np.ones(len(mates)), mates, x, y, z, np.sqrt(x * x + y * y + z * z)),
            *agents.velocity[match, mates].T,
            *(agents.yaw[match, mates], agents.health[match, mates]),
            *(agents.invincible_left[match, mates] > 0, agents.supplies[match, mates]),
        )
        readings = np.zeros((*counts.shape, self.limit, len(COLUMNS)), np.float32)
        readings[match, reader, place] = np.stack(columns, axis=-1)
        return readings

    def _nearest(
        self, state: "State", seats: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the nearest teammates of each seat, (B, S, up to limit), and the number of all, (B, S).

        If a seat has fewer teammates than columns, the other columns are meaningless.
        """
        agents, every = state.agents, np.arange(state.agents.team.shape[1])
        mates = agents.team[:, None] == agents.team[:, seats, None]
        mates &= (every != seats[:, None]) & (every < state.matches.seats[:, None, None])
        offsets = agents.position[:, None] - agents.position[:, seats, None]
        squares = np.where(mates, (offsets * offsets).sum(axis=-1), np.inf)
        return np.argsort(squares, axis=-1, kind="stable")[..., : self.limit], mates.sum(axis=-1)
