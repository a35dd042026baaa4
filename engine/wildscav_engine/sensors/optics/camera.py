"""The colour camera: shaded images of the match.

They show the sky, sunlight and shadows, the materials of surfaces, water, and haze that grows towards
``far``. Agents and supply boxes are visible. Of the viewer's own body, only the shadow is. Fast pictures
have the same shapes and shadows, but neither dark corners nor darker light under roofs.
"""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.parallel.turns import Turns
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.shading.render import render_pictures
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.image_sensor import ShownMaps
from wildscav_engine.sensors.optics.pinhole import PinholeCamera

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


@sensor
class ColorCamera(PinholeCamera):
    """Images in red, green and blue."""

    width: Annotated[int, Field(ge=1, le=1920)] = 160  # pixels in a row
    height: Annotated[int, Field(ge=1, le=1080)] = 90  # rows of pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 300.0  # m, where everything has faded into the haze
    field_of_view: Annotated[float, Field(ge=1, le=170)] = 75.0  # degrees, horizontally
    shadows: bool = True  # whether objects cast shadows
    quality: Literal["full", "fast"] = "full"  # fast: simpler light, and one colour for up to four pixels

    name: ClassVar[str] = "camera"
    title: ClassVar[str] = "image in red, green and blue, 0-255"
    dtype: ClassVar[type[np.generic]] = np.uint8
    ray_time: ClassVar[int] = 50
    channels: ClassVar[tuple[int, ...]] = (3,)

    @property
    def sees_objects(self) -> bool:
        """Always."""
        return True

    @property
    def bounds(self) -> tuple[float, float]:
        """0 and 255."""
        return 0, 255

    def prepare(self, game_map: "GameMap") -> None:
        """Compute what images of a map are made from, including its colours."""
        super().prepare(game_map)
        _ = game_map.appearance

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[np.uint8],
        turns: Turns,
    ) -> bool:
        """Render the pictures of cameras in different matches."""
        return render_pictures(
            *(shown.scenes, shown.appearances, objects, matches, cameras, images, turns),
            shadows=self.shadows,
            is_fast=self.quality == "fast",
        )
