"""The compass: the direction and the distance of the target, relative to the agent.

Five numbers: 1 if the agent knows a target; the sine and the cosine of its bearing, which is the angle
clockwise from the agent's yaw (0 and 1 straight ahead, 1 and 0 to the right; both 0 directly above or below
the target); its horizontal distance in m; and its height above the agent's soles in m. All are 0 if the track
has no target, or while the target is hidden from the agent's team.

Unlike an angle, the sine and cosine are continuous where the target is behind the agent.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, Sensor, row_space, rows_of, sensor

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match_view import MatchView

INF = np.inf
COLUMNS = (
    Column("known", "0 or 1", 0, 1, "whether the agent knows a target"),
    Column("sine", "", -1, 1, "sine of the target's bearing, clockwise from the view: 1 is to the right"),
    Column("cosine", "", -1, 1, "cosine of that bearing: 1 is straight ahead"),
    Column("distance", "m", 0, INF, "horizontal distance of the target"),
    Column("height", "m", -INF, INF, "height of the target above the agent's soles"),
)


@sensor
class Compass(Sensor):
    """Direction and distance of the target."""

    name: ClassVar[str] = "compass"
    title: ClassVar[str] = "the target: whether there is one, sine and cosine of its bearing, m away, m up"

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a reading."""
        return COLUMNS

    @property
    def space(self) -> "Box":
        """(5,)."""
        return row_space(COLUMNS)

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), 5).

        Raises:
            ValueError: The match has no such seat.
        """
        rows = rows_of(match, seats)
        readings = np.zeros((len(rows), len(COLUMNS)), np.float32)
        agents, matches = match.state.agents, match.state.matches
        known = np.flatnonzero(agents.knows_target[0, rows])
        pointed = readings[known]
        _point(agents.position[0, rows[known]], agents.yaw[0, rows[known]], matches.target[0], pointed)
        readings[known] = pointed
        return readings


@kernel
def _point(
    positions: NDArray[np.float64],
    yaws: NDArray[np.float64],
    target: NDArray[np.float64],
    readings: NDArray[np.float32],
) -> None:
    """Write (N, 5) readings for agents at (N, 3) m with (N,) yaws in degrees."""
    for row in range(positions.shape[0]):
        dx, dz = target[0] - positions[row, 0], target[2] - positions[row, 2]
        level = np.sqrt(dx * dx + dz * dz)
        sin_yaw, cos_yaw = sine(yaws[row]), cosine(yaws[row])
        readings[row, 0] = 1.0
        if level > 0.0:
            readings[row, 1] = max(-1.0, min(1.0, (dx * cos_yaw - dz * sin_yaw) / level))
            readings[row, 2] = max(-1.0, min(1.0, (dx * sin_yaw + dz * cos_yaw) / level))
        readings[row, 3] = level
        readings[row, 4] = target[1] - positions[row, 1]
