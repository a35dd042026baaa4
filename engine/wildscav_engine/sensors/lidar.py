"""The LIDAR: distances all round, in rings above one another.

Column 0 looks along the agent's yaw and azimuths grow clockwise; row 0 is the highest ring. The rings are
level whatever the agent's pitch. Distance is measured along the ray; where nothing is met within ``range``,
it reads ``range``. Water is not met, but its bed is. Agents and supply boxes are not in it, unless the option
``moving`` says so.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from wildscav_engine.geometry.rays import cast_ray
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optical import MovingOption
from wildscav_engine.trig import arctangent, cosine, sine

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap

Elevation = Annotated[float, Field(ge=-90, le=90)]


@sensor
class Lidar(MovingOption):
    """Distances all round in metres."""

    name: ClassVar[str] = "lidar"
    title: ClassVar[str] = "distances all round, m"
    dtype: ClassVar[type[np.generic]] = np.float32

    channels: Annotated[int, Field(ge=1, le=128)] = 16  # rings; a single one is halfway up
    azimuths: Annotated[int, Field(ge=1, le=3600)] = 360  # columns of a whole turn
    range: Annotated[float, Field(gt=0, le=2000)] = 100.0  # m
    lowest: Elevation = -15.0  # degrees above the horizon, of the lowest ring
    highest: Elevation = 15.0  # degrees, of the highest
    moving: bool = False  # whether agents and supply boxes are met

    @model_validator(mode="after")
    def _elevations_ascend(self) -> Self:
        if self.lowest > self.highest:
            raise ValueError(f"lowest is {self.lowest:g}, must not be above highest, {self.highest:g}")
        return self

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

    @property
    def space(self) -> "Box":
        """(channels, azimuths) m, from 0 to ``range``."""
        from gymnasium.spaces import Box

        return Box(np.float32(0.0), np.float32(self.range), self.shape, np.float32)

    def look(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> None:
        """Measure distances in m."""
        _scan(game_map.world, moving, cameras, self.elevations, images)


@kernel
def _scan(
    world: World,
    moving: Solids,
    cameras: Cameras,
    elevations: NDArray[np.float64],
    images: NDArray[np.float32],
) -> None:
    """Write (N, channels, azimuths) m of N viewers."""
    far, azimuths = np.float32(cameras.far), images.shape[2]
    for image in range(images.shape[0]):
        x, y, z = cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2]
        for column in range(azimuths):
            azimuth = cameras.yaws[image] + 360.0 * column / azimuths
            east, north = sine(azimuth), cosine(azimuth)
            for channel in range(images.shape[1]):
                level, rise = cosine(elevations[channel]), sine(elevations[channel])
                hit = cast_ray(world, x, y, z, east * level, rise, north * level, cameras.far)
                images[image, channel, column] = min(far, np.float32(hit.distance))
        for solid in range(moving.kind.shape[0]):
            if moving.owner[solid] != cameras.viewers[image]:
                _scan_solid(moving, solid, cameras, image, elevations, images[image])


@kernel
def _scan_solid(
    moving: Solids,
    solid: int,
    cameras: Cameras,
    image: int,
    elevations: NDArray[np.float64],
    distances: NDArray[np.float32],
) -> None:
    """Shorten the distances of one viewer to a solid, wherever it is met before."""
    x, y, z = cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2]
    azimuths = distances.shape[1]
    first, last = _columns_over(moving, solid, x, z, cameras.yaws[image], azimuths)
    for place in range(first, last + 1):
        column = place % azimuths
        azimuth = cameras.yaws[image] + 360.0 * column / azimuths
        east, north = sine(azimuth), cosine(azimuth)
        for channel in range(distances.shape[0]):
            level, rise = cosine(elevations[channel]), sine(elevations[channel])
            nearest = np.float64(distances[channel, column])
            met = _meet(moving, solid, (x, y, z), (east * level, rise, north * level), nearest)
            if met < nearest:
                distances[channel, column] = met


@kernel
def _columns_over(
    moving: Solids, solid: int, x: float, z: float, yaw: float, azimuths: int
) -> tuple[int, int]:
    """Return the first and the last column that may meet a solid; modulo the number of columns."""
    half_x = (moving.high[solid, 0] - moving.low[solid, 0]) * 0.5
    half_z = (moving.high[solid, 2] - moving.low[solid, 2]) * 0.5
    dx, dz = moving.low[solid, 0] + half_x - x, moving.low[solid, 2] + half_z - z
    radius = half_x * half_x + half_z * half_z
    away = dx * dx + dz * dz
    if away <= radius:
        return 0, azimuths - 1
    # Half the angle under which the circle around the solid is seen from above.
    half = arctangent(np.sqrt(radius), np.sqrt(away - radius))
    middle = arctangent(dx, dz) - yaw
    column = azimuths / 360.0
    first = int(np.floor((middle - half) * column))
    last = int(np.ceil((middle + half) * column))
    return first, min(last, first + azimuths - 1)


@kernel
def _meet(
    moving: Solids,
    solid: int,
    eye: tuple[float, float, float],
    way: tuple[float, float, float],
    nearest: float,
) -> float:
    """Return where a ray enters a solid, m; inf if it does not before ``nearest``.

    Clips the ray by each face: Cyrus & Beck, "Generalized Two- and Three-Dimensional Clipping", 1978.
    """
    enter, leave = 0.0, nearest
    for face in range(moving.face_start[solid], moving.face_start[solid + 1]):
        n_x, n_y, n_z = moving.faces[face, 0], moving.faces[face, 1], moving.faces[face, 2]
        outside = n_x * eye[0] + n_y * eye[1] + n_z * eye[2] - moving.faces[face, 3]
        speed = n_x * way[0] + n_y * way[1] + n_z * way[2]
        if speed < 0.0:
            enter = max(enter, -outside / speed)
        elif outside > 0.0:
            return np.inf
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
        if enter > leave:
            return np.inf
    return enter
