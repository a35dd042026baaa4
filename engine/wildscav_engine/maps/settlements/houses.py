"""The houses of a finished map: their positions, sizes and rooms."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import Pose, Rectangle, pose


class Room(NamedTuple):
    """A room of a house: the area between its walls."""

    level: int  # 0 is the ground floor
    area: Rectangle  # m, in the axes of the house


@dataclass(frozen=True)
class House:
    """A house on the map: a rectangle rotated about its middle."""

    center: tuple[float, float]  # m, x and z
    size: tuple[float, float]  # m, width and depth before turning
    yaw: float  # degrees
    ground: float  # m, height of its ground floor
    storeys: int
    storey_height: float  # m
    wings: tuple[Rectangle, ...] = ()  # m, in its own axes: the outlines of its parts, walls included
    rooms: tuple[Room, ...] = ()

    @property
    def pose(self) -> Pose:
        """The axes of the house: across, and along towards its front."""
        return pose(*self.center, self.yaw)

    @property
    def outline(self) -> Rectangle:
        """All of it with its walls, in its own axes."""
        across, along = self.size[0] / 2.0, self.size[1] / 2.0
        return Rectangle(-across, -along, across, along)

    def covers(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (N,) which places, (N, 3) m, lie within its outline, seen from above."""
        return self.outline.holds(*self.pose.inside(places[:, 0], places[:, 2]))
