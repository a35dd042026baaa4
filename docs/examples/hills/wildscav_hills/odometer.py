"""The odometer: how far the agent has walked."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.simulation.state import Agents, Matches


@kernel
def write_walked(agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]) -> None:
    """Write the way walked since the start."""
    row[0] = agents.walked[match, seat]


@sensor
class Odometer(ScalarSensor):
    """The way that the agent has walked."""

    name: ClassVar[str] = "odometer"
    title: ClassVar[str] = "m walked since the start"
    scalars: ClassVar[tuple[Column, ...]] = (Column("walked", "m", 0, 100_000, "way walked"),)

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the number."""
        return write_walked
