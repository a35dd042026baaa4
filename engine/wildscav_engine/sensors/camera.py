"""The colour camera: shaded images of the match.

They show the sky, sunlight and shadows, the materials of surfaces, water, and haze that grows towards
``far``. Agents and supply boxes are visible. Of the viewer's own body, only the shadow is.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.shading.pictures import shade
from wildscav_engine.rendering.trace import Hits
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.dynamic_objects import as_dynamic_objects, dynamic_objects_of
from wildscav_engine.sensors.optics.pinhole import RayHitCamera

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView


@sensor
class ColorCamera(RayHitCamera):
    """Images in red, green and blue."""

    width: Annotated[int, Field(ge=1, le=1920)] = 160  # pixels
    height: Annotated[int, Field(ge=1, le=1080)] = 90  # pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 300.0  # m, where everything has faded into the haze
    field_of_view: Annotated[float, Field(ge=1, le=170)] = 75.0  # degrees, horizontally
    shadows: bool = True  # whether objects cast shadows

    name: ClassVar[str] = "camera"
    title: ClassVar[str] = "image in red, green and blue, 0-255"
    dtype: ClassVar[type[np.generic]] = np.uint8
    ray_time: ClassVar[int] = 100
    channels: ClassVar[tuple[int, ...]] = (3,)
    sees_water: ClassVar[bool] = True

    @property
    def space(self) -> "Box":
        """(height, width, 3) red, green and blue, 0-255."""
        from gymnasium.spaces import Box

        return Box(0, 255, self.shape, np.uint8)

    def prepare(self, game_map: "GameMap") -> None:
        """Compute what images of a map are made from, including its colours."""
        super().prepare(game_map)
        _ = game_map.materials

    def moving_in(self, match: "MatchView") -> Solids:
        """Return the living agents and the supply boxes of the match."""
        return dynamic_objects_of(match)

    def write_pixels(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, hits: Hits, images: NDArray[np.uint8]
    ) -> None:
        """Shade the surfaces that the rays hit."""
        objects = as_dynamic_objects(moving)
        shade(game_map.world, game_map.materials, objects, cameras, hits, images, shadows=self.shadows)
