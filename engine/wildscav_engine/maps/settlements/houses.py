"""The houses of a map as everything else sees them: where each stands, and its rooms."""

from dataclasses import dataclass
from typing import NamedTuple

from wildscav_engine.geometry.shapes import Pose, Rectangle, pose


class Room(NamedTuple):
    """A room of a house: what lies between its walls."""

    level: int  # 0 is the ground floor
    area: Rectangle  # m, in the axes of the house


@dataclass(frozen=True)
class House:
    """Where a house stands: a rectangle turned about its middle."""

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
        """Its own axes: across, and along to its front."""
        return pose(*self.center, self.yaw)
