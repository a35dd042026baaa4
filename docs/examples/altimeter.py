"""The altimeter: how high the soles are above what is below them: ground, floor, roof or water."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.sensors.base import Sensor, rows_of, sensor

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.simulation.match import Match

LIFT = 0.1  # m above the soles, where the ray starts: they may touch what they stand on


@sensor
class Altimeter(Sensor):
    """Height above what is below."""

    name: ClassVar[str] = "altimeter"
    title: ClassVar[str] = "height above ground, floor, roof or water, m"

    reach: Annotated[float, Field(gt=0, le=1000)] = 50.0  # m; what is farther below reads as this

    @property
    def space(self) -> "Box":
        """(1,) m, from 0 to ``reach``."""
        from gymnasium.spaces import Box

        return Box(np.float32(0.0), np.float32(self.reach), (1,), np.float32)

    def read(self, match: "Match", seats: Sequence[int]) -> NDArray[np.float32]:
        """Return (len(seats), 1) m.

        Raises:
            ValueError: The match has no such seat.
        """
        world, positions = match.game_map.world, match.state.agents.position[0, rows_of(match, seats)]
        readings = np.empty((len(positions), 1), np.float32)
        for row, (x, y, z) in enumerate(positions.tolist()):
            below = raycast(world, x, y + LIFT, z, 0.0, -1.0, 0.0, self.reach + LIFT).distance - LIFT
            readings[row] = min(max(0.0, min(below, y - water_at(world, x, z))), self.reach)
        return readings
