"""The depth camera: planar depth of the static world through a pinhole.

Depth is measured along the view axis, not along the ray: a wall seen straight on reads the same in every
pixel. What lies farther than ``far`` along its ray reads ``far``. Agents and supply boxes are not in it,
unless the option ``moving`` says so.
"""

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.solids import Solids
from wildscav_engine.rendering.trace import trace_depths
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

    def look(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> bool:
        """Make the images of some cameras."""
        return trace_depths(game_map.scene, moving, cameras, images)
