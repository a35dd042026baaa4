"""The ways to the centres of the latest wave of supplies and of the next one, relative to the agent's yaw.

Nine numbers: 1 if a wave has appeared; the way to the centre of the latest one to the right of the yaw and
along it, of 1; the logarithm of its horizontal distance; the same four numbers of the next wave; and the time
until it appears (s). What is not known is 0. The places of the hot spot are among the waves, as in what all
agents are told before the match.
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
    Column("appeared", "0 or 1", 0, 1, "whether a wave has appeared"),
    Column("right", "of 1", -1, 1, "the way to the latest one's centre: its part to the right of the yaw"),
    Column("ahead", "of 1", -1, 1, "the same way's part along the yaw"),
    Column("log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
    Column("next", "0 or 1", 0, 1, "whether there will be another wave"),
    Column("next right", "of 1", -1, 1, "the way to the next one's centre: its part to the right of the yaw"),
    Column("next ahead", "of 1", -1, 1, "the same way's part along the yaw"),
    Column("next log distance", "ln m", 0, 10, "logarithm of 1 m + the horizontal distance"),
    Column("comes_in", "s", 0, np.inf, "time until the next wave appears"),
)


@kernel
def _write_to_waves(
    agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]
) -> None:
    """Write the ways of a seat to the waves; all 0 if there are none."""
    frame, count = matches.frame[match], matches.waves[match]
    write_ways(agents, match, seat, frame, matches.wave_centers[match], count, row)


@sensor
class ToWaves(ScalarSensor):
    """The ways to the centres of the latest wave and of the next one, relative to the yaw."""

    name: ClassVar[str] = "to_waves"
    title: ClassVar[str] = (
        "the way to the latest wave's centre: appeared, right, ahead, log distance, ln m; the same of the "
        "next wave; s until it appears"
    )
    scalars: ClassVar[tuple[Column, ...]] = COLUMNS

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_to_waves
