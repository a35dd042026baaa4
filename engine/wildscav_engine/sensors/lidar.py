"""The LIDAR: distances in all horizontal directions, in rings of different elevations.

Column 0 points along the agent's yaw, and azimuths grow clockwise. Row 0 is the highest ring. The rings stay
level whatever the agent's pitch. Distance is measured along the ray; a ray that hits nothing within ``range``
reads ``range``. Rays pass through water to its bed. Agents and supply boxes are invisible unless the option
``moving`` is set.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.ray_fans import RayFans, cast_ray_fan, meet_solid_with_ray_fan
from wildscav_engine.geometry.rays import Ray, make_ray
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.cameras import Cameras, are_finite
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.optical import MovingOption

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap

# The least cosine of an elevation: rays straight up and down lean by this little.
MIN_COSINE = 1e-12
Elevation = Annotated[float, Field(ge=-90, le=90)]


@sensor
class Lidar(MovingOption):
    """Distances in all horizontal directions in metres."""

    name: ClassVar[str] = "lidar"
    title: ClassVar[str] = "distances in all directions, m"
    dtype: ClassVar[type[np.generic]] = np.float32
    ray_time: ClassVar[int] = 50

    channels: Annotated[int, Field(ge=1, le=128)] = (
        16  # rings; a single one is halfway between the elevations
    )
    azimuths: Annotated[int, Field(ge=1, le=3600)] = 360  # columns of a full turn
    range: Annotated[float, Field(ge=0.01, le=2000)] = 100.0  # m
    lowest: Elevation = -15.0  # degrees above the horizon, of the lowest ring
    highest: Elevation = 15.0  # degrees above the horizon, of the highest ring
    moving: bool = False  # whether agents and supply boxes are visible

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

    def render_into(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> bool:
        """Measure distances in m."""
        if not are_finite(cameras.eyes, cameras.yaws, cameras.pitches):
            return False
        world = game_map.world
        levels, slopes = np.empty(self.channels), np.empty(self.channels)
        reach = np.empty((self.azimuths, self.channels))
        fans = RayFans(slopes, reach, np.empty(len(world.solid_kind), np.int64))
        _aim(self.elevations, levels, slopes)
        _scan(world, Solids(*moving), cameras, levels, fans, images)
        return True


@kernel
def _aim(elevations: NDArray[np.float64], levels: NDArray[np.float64], slopes: NDArray[np.float64]) -> None:
    """Write for each ring its horizontal distance per metre of a ray, and its slope."""
    for channel in range(elevations.shape[0]):
        levels[channel] = max(cosine(elevations[channel]), MIN_COSINE)
        slopes[channel] = sine(elevations[channel]) / levels[channel]


@kernel
def _scan(
    world: World,
    moving: Solids,
    cameras: Cameras,
    levels: NDArray[np.float64],
    fans: RayFans,
    images: NDArray[np.float32],
) -> None:
    """Write (N, channels, azimuths) m for N viewers, with one fan of rays per azimuth."""
    for image in range(images.shape[0]):
        fans.seen_by[:] = -1
        for column in range(images.shape[2]):
            for channel in range(images.shape[1]):
                fans.reach[column, channel] = cameras.far * levels[channel]
            cast_ray_fan(world, fans, column, _column_ray(world, cameras, image, column, images.shape[2]))
        for solid in range(moving.kind.shape[0]):
            if moving.owner[solid] != cameras.viewers[image]:
                _scan_solid(world, moving, solid, cameras, image, fans)
        for column in range(images.shape[2]):
            for channel in range(images.shape[1]):
                distance = fans.reach[column, channel] / levels[channel]
                images[image, channel, column] = min(np.float32(cameras.far), np.float32(distance))


@kernel
def _column_ray(world: World, cameras: Cameras, image: int, column: int, azimuths: int) -> Ray:
    """Return the horizontal ray of a column."""
    azimuth = cameras.yaws[image] + 360.0 * column / azimuths
    x, y, z = cameras.eyes[image, 0], cameras.eyes[image, 1], cameras.eyes[image, 2]
    return make_ray(world, x, y, z, sine(azimuth), 0.0, cosine(azimuth))


@kernel
def _scan_solid(
    world: World, moving: Solids, solid: int, cameras: Cameras, image: int, fans: RayFans
) -> None:
    """Shorten the distances of one viewer to a solid wherever it is nearer."""
    solids = (moving.low, moving.high, moving.face_start, moving.faces)
    azimuths, channels = fans.reach.shape
    x, z = cameras.eyes[image, 0], cameras.eyes[image, 2]
    first, last = _columns_over(moving, solid, x, z, cameras.yaws[image], azimuths)
    for place in range(first, last + 1):
        column = place % azimuths
        ray = _column_ray(world, cameras, image, column, azimuths)
        meet_solid_with_ray_fan(solids, solid, fans, column, ray, channels - 1)


@kernel
def _columns_over(
    moving: Solids, solid: int, x: float, z: float, yaw: float, azimuths: int
) -> tuple[int, int]:
    """Return the first and the last column that may hit a solid, modulo the number of columns."""
    half_x = (moving.high[solid, 0] - moving.low[solid, 0]) * 0.5
    half_z = (moving.high[solid, 2] - moving.low[solid, 2]) * 0.5
    dx, dz = moving.low[solid, 0] + half_x - x, moving.low[solid, 2] + half_z - z
    radius = half_x * half_x + half_z * half_z
    away = dx * dx + dz * dz
    if away <= radius:
        return 0, azimuths - 1
    # Half the angle that the circle around the solid subtends, seen from above.
    half = arctangent(np.sqrt(radius), np.sqrt(away - radius))
    middle = arctangent(dx, dz) - yaw
    column = azimuths / 360.0
    first = int(np.floor((middle - half) * column))
    last = int(np.ceil((middle + half) * column))
    return first, min(last, first + azimuths - 1)
