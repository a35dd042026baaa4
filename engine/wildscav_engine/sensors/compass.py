"""The compass: the direction and the distance of the target, relative to the agent.

Five numbers: 1 if the agent knows a target; the sine and the cosine of its bearing, which is the angle
clockwise from the agent's yaw (0 and 1 straight ahead, 1 and 0 to the right; both 0 directly above or below
the target); its horizontal distance in m; and its height above the agent's soles in m. All are 0 if the track
has no target, or while the target is hidden from the agent's team.

Unlike an angle, the sine and cosine are continuous where the target is behind the agent.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.sensors.base import Column, sensor
from wildscav_engine.sensors.scalars import ScalarSensor, Write
from wildscav_engine.simulation.state import Agents, Matches

INF = np.inf
COLUMNS = (
    Column("known", "0 or 1", 0, 1, "whether the agent knows a target"),
    Column("sine", "", -1, 1, "sine of the target's bearing, clockwise from the view: 1 is to the right"),
    Column("cosine", "", -1, 1, "cosine of that bearing: 1 is straight ahead"),
    Column("distance", "m", 0, INF, "horizontal distance of the target"),
    Column("height", "m", -INF, INF, "height of the target above the agent's soles"),
)


@kernel
def _write_compass(agents: Agents, matches: Matches, match: int, seat: int, row: NDArray[np.float32]) -> None:
    """Write where the target is; all 0 if the seat does not know it."""
    if not agents.knows_target[match, seat]:
        return
    target, position, yaw = matches.target[match], agents.position[match, seat], agents.yaw[match, seat]
    dx, dz = target[0] - position[0], target[2] - position[2]
    level = np.sqrt(dx * dx + dz * dz)
    sin_yaw, cos_yaw = sine(yaw), cosine(yaw)
    row[0] = 1.0
    if level > 0.0:
        row[1] = max(-1.0, min(1.0, (dx * cos_yaw - dz * sin_yaw) / level))
        row[2] = max(-1.0, min(1.0, (dx * sin_yaw + dz * cos_yaw) / level))
    row[3] = level
    row[4] = target[1] - position[1]


@sensor
class Compass(ScalarSensor):
    """Direction and distance of the target."""

    name: ClassVar[str] = "compass"
    title: ClassVar[str] = "the target: whether there is one, sine and cosine of its bearing, m away, m up"
    scalars: ClassVar[tuple[Column, ...]] = COLUMNS

    @staticmethod
    def kernel() -> Write:
        """Return the kernel that writes the numbers."""
        return _write_compass
