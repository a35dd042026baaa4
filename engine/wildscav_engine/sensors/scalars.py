"""Sensors that read a few numbers about an agent from the state with a kernel.

Such a sensor gives agents numbers in addition to those of the protocol's ``Observation``. It defines columns
and a kernel. Everything else follows from these: the space of environments, the tensor that agents receive,
and the tables of the documentation. In environments, one call reads it for all matches.
"""

import functools
from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel_beside
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.sensors.base import Sight, StateSensor
from wildscav_engine.simulation.state import Agents, Matches, agents_at, matches_at

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

# Writes one seat's numbers; takes the agents and matches of a batch, a match, a seat, and the row to write.
Write = Callable[[Agents, Matches, int, int, NDArray[np.float32]], None]


class ScalarSensor(StateSensor):
    """A few numbers about an agent."""

    sight: ClassVar[Sight] = "none"

    @staticmethod
    @abstractmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers of one seat into a row of zeros, in order."""

    def read_batch(
        self,
        state: "State",
        seen: "Seen",  # noqa: ARG002
        seats: NDArray[np.int64],
    ) -> NDArray[np.float32]:
        """Return (B, len(seats), columns) readings of the same seats in all matches."""
        readings = np.zeros((len(state.matches.frame), len(seats), len(self.scalars)), np.float32)
        agents, _, matches = state.tables
        reader_of(self.kernel())(agents.addresses, matches.addresses, seats, readings)
        return readings


@functools.cache
def reader_of(write: Write) -> Callable[[Addresses, Addresses, NDArray[np.int64], NDArray[np.float32]], None]:
    """Return the kernel that reads some seats of all matches with one sensor's kernel."""

    def read(
        agents: Addresses, matches: Addresses, seats: NDArray[np.int64], readings: NDArray[np.float32]
    ) -> None:
        every_agent, every_match = agents_at(agents), matches_at(matches)
        for match in range(readings.shape[0]):
            for index in range(readings.shape[1]):
                write(every_agent, every_match, match, seats[index], readings[match, index])

    # Compiled code is kept by these names.
    read.__module__, read.__qualname__ = write.__module__, f"read_by_{write.__qualname__}"
    return kernel_beside(write, read)
