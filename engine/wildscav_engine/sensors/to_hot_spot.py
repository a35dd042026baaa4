"""The ways to the hot spot and to its next place, relative to the agent's yaw.

Nine numbers: 1 if the hot spot is at a place; the way there to the right of the yaw and along it, of 1; the
logarithm of its horizontal distance; the same four numbers of the next place; and the time until the hot spot
comes there (s). What is not known is 0, as in the sensor ``hot_spot``.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.sensors.ways import write_ways
from wildscav_engine.simulation.state import Agents, Matches

COLUMNS = (
    Column("here", "0 or 1", 0, 1, "whether the hot spot is at a place"),
    Column("right", "of 1", -1, 1, "the way there: its part to the right of the yaw"),
    Column("ahead", "of 1", -1, 1, "the same way's part along the yaw"),
    Column("log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
    Column("next", "0 or 1", 0, 1, "whether it comes to another place"),
    Column("next right", "of 1", -1, 1, "the way to the next place: its part to the right of the yaw"),
    Column("next ahead", "of 1", -1, 1, "the same way's part along the yaw"),
    Column("next log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
    Column("comes_in", "s", 0, np.inf, "time until it comes to its next place"),
)


@kernel
def _write_to_hot_spot(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    """Write the ways of a seat to the hot spot; all 0 if there is none."""
    frame, count = matches.frame[match], matches.places[match]
    write_ways(agents, match, seat, frame, matches.hot_spots[match], count, row)


@sensor
class ToHotSpot(ScalarSensor):
    """The ways to the hot spot and to its next place, relative to the yaw."""

    name: ClassVar[str] = "to_hot_spot"
    title: ClassVar[str] = (
        "the way to the hot spot: known, right, ahead, log distance, ln m; the same of its next place; s "
        "until it comes there"
    )
    scalars: ClassVar[tuple[Column, ...]] = COLUMNS

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_to_hot_spot
