"""The depth camera: planar depth of the static world through a pinhole.

Depth is measured along the view axis, not along the ray: a wall seen straight on reads the same in every
pixel. What lies farther than ``far`` along its ray reads ``far``. Agents and supply boxes are not in it,
unless the option ``moving`` says so.
"""

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.kernel import kernel
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.solids import Solids
from wildscav_engine.rendering.trace import Hits
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optical import MovingOption
from wildscav_engine.sensors.pinhole import PinholeCamera

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap


@sensor
class DepthCamera(MovingOption, PinholeCamera):
    """Depth maps in metres."""

    name: ClassVar[str] = "depth"
    title: ClassVar[str] = "planar depth, m"
    dtype: ClassVar[type[np.generic]] = np.float32

    moving: bool = False  # whether agents and supply boxes are seen

    @property
    def space(self) -> "Box":
        """(height, width) m, from 0 to ``far``."""
        from gymnasium.spaces import Box

        return Box(np.float32(0.0), np.float32(self.far), self.shape, np.float32)

    def paint(
        self,
        game_map: "GameMap",  # noqa: ARG002
        moving: Solids,  # noqa: ARG002
        cameras: Cameras,
        hits: Hits,
        images: NDArray[np.float32],
    ) -> None:
        """Write depths in m."""
        _flatten(hits.distance, cameras.half_width, np.float32(cameras.far), images)


@kernel
def _flatten(
    distances: NDArray[np.float32], half_width: float, far: np.float32, depths: NDArray[np.float32]
) -> None:
    """Write (N, H, W) depths along the view axis for distances along the rays."""
    images, height, width = distances.shape
    pixel = 2.0 * half_width / width
    for row in range(height):
        up = (height * 0.5 - row - 0.5) * pixel
        for column in range(width):
            right = (column + 0.5 - width * 0.5) * pixel
            along = 1.0 / np.sqrt(1.0 + up * up + right * right)
            for image in range(images):
                distance = distances[image, row, column]
                depths[image, row, column] = far if distance > far else np.float32(distance * along)
