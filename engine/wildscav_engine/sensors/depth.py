"""The depth camera: planar depth of the static world through a pinhole.

Depth is measured along the view axis, not along the ray: a wall seen straight on reads the same in every
pixel. What lies farther than ``far`` along its ray reads ``far``. Horizontal field of view 60°, square
pixels, rays through pixel centres, row 0 at the top, column 0 at the left. Agents and supply boxes are not
in it.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.body import EYE_HEIGHT
from wildscav_engine.geometry.rays import cast_ray
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.sensors.base import SensorConfig, parse_options
from wildscav_engine.trig import cosine, sine

if TYPE_CHECKING:
    from wildscav_engine.match import Match

HALF_WIDTH = 0.5773502691896257  # tangent of half the field of view, 30°


class DepthConfig(SensorConfig):
    """How many pixels, at most those of the paper's largest depth map, and how far they see."""

    width: Annotated[int, Field(ge=1, le=380)] = 38  # pixels
    height: Annotated[int, Field(ge=1, le=220)] = 22  # pixels
    far: Annotated[float, Field(gt=0, le=2000)] = 100.0  # m


class DepthSensor:
    """Depth maps in metres."""

    name = "depth"
    title = "planar depth of the static world, m"
    dtype: np.dtype[np.generic] = np.dtype(np.float32)

    def parse(self, options: Mapping[str, object]) -> DepthConfig:
        """Check options as they stand in ``submission.toml``.

        Raises:
            ValueError: One line with the option, what is wrong and what is allowed.
        """
        return parse_options(DepthConfig, self.name, options)

    def shape(self, config: SensorConfig) -> tuple[int, ...]:
        """Return (height, width)."""
        own = _own(config)
        return (own.height, own.width)

    def read(self, match: "Match", seats: Sequence[int], config: SensorConfig) -> NDArray[np.float32]:
        """Return (len(seats), height, width) metres, seen from the eyes of some agents."""
        own = _own(config)
        rows = np.array(seats, np.int64)
        agents = match.state.agents
        eyes = agents.position[0, rows]
        eyes[:, 1] += EYE_HEIGHT
        images = np.empty((len(rows), own.height, own.width), np.float32)
        render_depth(match.game_map.world, eyes, agents.yaw[0, rows], agents.pitch[0, rows], own.far, images)
        return images


def _own(config: SensorConfig) -> DepthConfig:
    if not isinstance(config, DepthConfig):
        raise TypeError(f"the depth sensor takes a DepthConfig, not a {type(config).__name__}")
    return config


@kernel
def render_depth(
    world: World,
    eyes: NDArray[np.float64],
    yaws: NDArray[np.float64],
    pitches: NDArray[np.float64],
    far: float,
    images: NDArray[np.float32],
) -> None:
    """Render depth maps.

    Args:
        world: The static world.
        eyes: (N, 3) m.
        yaws: (N,) degrees.
        pitches: (N,) degrees.
        far: m.
        images: (N, height, width) m, written.
    """
    for viewer in range(images.shape[0]):
        _render_one(world, eyes[viewer], yaws[viewer], pitches[viewer], far, images[viewer])


@kernel
def _render_one(
    world: World, eye: NDArray[np.float64], yaw: float, pitch: float, far: float, image: NDArray[np.float32]
) -> None:
    height, width = image.shape
    sin_yaw, cos_yaw, sin_pitch, cos_pitch = sine(yaw), cosine(yaw), sine(pitch), cosine(pitch)
    pixel = 2.0 * HALF_WIDTH / width
    for row in range(height):
        up = (height * 0.5 - row - 0.5) * pixel
        # The pixel's direction is axis + right · u + above · v, axis being the view direction.
        level, rise = cos_pitch + sin_pitch * up, cos_pitch * up - sin_pitch
        for column in range(width):
            right = (column + 0.5 - width * 0.5) * pixel
            dx = sin_yaw * level + cos_yaw * right
            dz = cos_yaw * level - sin_yaw * right
            along = 1.0 / np.sqrt(1.0 + up * up + right * right)
            hit = cast_ray(world, eye[0], eye[1], eye[2], dx * along, rise * along, dz * along, far)
            image[row, column] = far if hit.distance > far else hit.distance * along
