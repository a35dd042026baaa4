"""The range camera: the distance along the ray of each pixel."""

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import allocate_hits
from wildscav_engine.rendering.images import trace
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.pinhole import PinholeCamera

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


@sensor
class RangeCamera(PinholeCamera):
    """Distances along rays in metres."""

    name: ClassVar[str] = "range"
    title: ClassVar[str] = "distance along the ray of each pixel, m"
    dtype: ClassVar[type[np.generic]] = np.float32

    def render_into(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> bool:
        """Write the distances to what the rays hit."""
        hits = allocate_hits(*images.shape)
        if not trace(game_map.scene, moving, cameras, hits):
            return False
        np.minimum(hits.distance, self.far, out=images)
        return True
