"""The colour camera: pictures as a person would see them.

Sky, sun and shadows, the materials of things, water, haze towards ``far``; agents and supply boxes are in
it; of the viewer's own body there is only its shadow.
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
from wildscav_engine.sensors.optics.pinhole import PaintedCamera

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView


@sensor
class ColorCamera(PaintedCamera):
    """Pictures in red, green and blue."""

    width: Annotated[int, Field(ge=1, le=1920)] = 160  # pixels
    height: Annotated[int, Field(ge=1, le=1080)] = 90  # pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 300.0  # m, where all has faded into the haze
    field_of_view: Annotated[float, Field(ge=1, le=170)] = 75.0  # degrees from the left edge to the right
    shadows: bool = True  # whether things cast shadows

    name: ClassVar[str] = "camera"
    title: ClassVar[str] = "picture in red, green and blue, 0-255"
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
        """Make what images of a map are made from, its colours included."""
        super().prepare(game_map)
        _ = game_map.materials

    def moving_in(self, match: "MatchView") -> Solids:
        """Return the living agents and the supply boxes that are there."""
        return dynamic_objects_of(match)

    def paint(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, hits: Hits, images: NDArray[np.uint8]
    ) -> None:
        """Write colours."""
        objects = as_dynamic_objects(moving)
        shade(game_map.world, game_map.materials, objects, cameras, hits, images, shadows=self.shadows)
