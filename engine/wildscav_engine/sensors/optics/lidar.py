"""The LIDAR: distances in all horizontal directions, in rings of different elevations.

Column 0 points along the agent's yaw, and azimuths grow clockwise. Row 0 is the highest ring. The rings stay
level whatever the agent's pitch. Distance is measured along the ray; a ray that hits nothing within ``range``
reads ``range``. Rays pass through water to its bed. Agents and supply boxes are invisible unless the option
``moving`` is set.
"""

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from wildscav_engine.parallel.turns import Turns, items_of
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.panorama import Panorama
from wildscav_engine.sensors.base import Sensor, sensor
from wildscav_engine.sensors.optics.image_sensor import ImageSensor, ShownMaps, select_cameras

if TYPE_CHECKING:
    from collections.abc import Sequence


Elevation = Annotated[float, Field(ge=-90, le=90)]


@sensor
class Lidar(ImageSensor):
    """Distances in all horizontal directions in metres."""

    name: ClassVar[str] = "lidar"
    title: ClassVar[str] = "distances in all directions, m"
    dtype: ClassVar[type[np.generic]] = np.float32
    ray_time: ClassVar[int] = 40

    channels: Annotated[int, Field(ge=1, le=128)] = 16  # rings; a single one is halfway between the two ends
    azimuths: Annotated[int, Field(ge=1, le=3600)] = 360  # columns of a full turn
    range: Annotated[float, Field(ge=0.01, le=2000)] = 100.0  # m; nothing farther is seen
    lowest: Elevation = -15.0  # degrees above the horizon, of the lowest ring
    highest: Elevation = 15.0  # degrees above the horizon, of the highest ring
    moving: bool = False  # whether agents and supply boxes are visible

    @model_validator(mode="after")
    def _elevations_ascend(self) -> Self:
        if self.lowest > self.highest:
            raise ValueError(f"lowest is {self.lowest:g}, must not be above highest, {self.highest:g}")
        return self

    @classmethod
    def warmers(cls) -> "Sequence[Sensor]":
        """Return one LIDAR both with rings that are traced together and with steep ones."""
        return (cls(channels=3, lowest=-90.0, highest=90.0),)

    @property
    def shape(self) -> tuple[int, ...]:
        """(channels, azimuths)."""
        return (self.channels, self.azimuths)

    @property
    def lens(self) -> tuple[float, float]:
        """No half width, and ``range``."""
        return 0.0, self.range

    @property
    def elevations(self) -> NDArray[np.float64]:
        """(channels,) degrees above the horizon, descending."""
        if self.channels == 1:
            return np.array([(self.highest + self.lowest) / 2.0])
        steps = np.arange(self.channels) / (self.channels - 1)
        return self.highest + (self.lowest - self.highest) * steps

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[np.float32],
        turns: Turns,
    ) -> bool:
        """Measure distances in m."""
        if not are_finite(cameras.eyes, cameras.yaws, cameras.pitches):
            return False
        panorama, scenes = self._panorama, shown.scenes
        if not panorama.is_steep:
            panorama.trace(scenes, objects, matches, cameras, images, turns)
            return True
        for row in items_of(turns, len(images)):
            part, game_map = slice(row, row + 1), shown.map_of(row)
            some, image = select_cameras(cameras, part), images[part]
            panorama.trace(game_map.scene, objects, matches[part], some, image)
            panorama.cast_steep_rays(game_map.world, objects.solids_of(matches[row]), some, image)
        return True

    @cached_property
    def _panorama(self) -> Panorama:
        return Panorama(self.azimuths, self.elevations)
