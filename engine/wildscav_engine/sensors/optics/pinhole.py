"""What all cameras share: a pinhole, whose rays go through the centres of square pixels.

Row 0 is at the top, column 0 at the left.
"""

from abc import abstractmethod
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.trace import Hits, allocate_hits, trace
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.optical import OpticalSensor, some_of

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


RAYS_AT_ONCE = 2**20


@lru_cache(maxsize=64)
def _half_width(field_of_view: float) -> float:
    """Return the tangent of half a field of view in degrees."""
    return sine(field_of_view / 2.0) / cosine(field_of_view / 2.0)


@sensor
class PinholeCamera(OpticalSensor):
    """A camera: how many pixels it has, how wide and how far it sees."""

    width: Annotated[int, Field(ge=1, le=1920)] = 38  # pixels
    height: Annotated[int, Field(ge=1, le=1080)] = 22  # pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 100.0  # m along the ray; nothing beyond is met
    field_of_view: Annotated[float, Field(ge=1, le=170)] = 60.0  # degrees from the left edge to the right

    channels: ClassVar[tuple[int, ...]] = ()  # length of the axes after height and width

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape of one image."""
        return (self.height, self.width, *self.channels)

    @cached_property
    def lens(self) -> tuple[float, float]:
        """The tangent of half the field of view, and ``far``."""
        return _half_width(self.field_of_view), self.far


class PaintedCamera(PinholeCamera):
    """A camera whose pixels are made from what their rays met: each kind says how (``paint``)."""

    sees_water: ClassVar[bool] = False  # whether rays meet the surface of water; else they go to its bed

    @abstractmethod
    def paint(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, hits: Hits, images: NDArray[Any]
    ) -> None:
        """Make pixels from what their rays met.

        Args:
            game_map: The map that is looked at.
            moving: What is in it besides.
            cameras: N cameras.
            hits: Of N images.
            images: (N, *shape), written.
        """

    def look(self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[Any]) -> bool:
        """Make the images of some cameras."""
        # Some at a time: what all rays of many images meet would take more memory than the images.
        each = max(1, RAYS_AT_ONCE // (self.height * self.width))
        for first in range(0, len(images), each):
            part = slice(first, first + each)
            some = cameras if each >= len(images) else some_of(cameras, part)
            hits = allocate_hits(len(some.yaws), self.height, self.width)
            if not trace(game_map.scene, moving, some, hits, with_water=self.sees_water):
                return False
            self.paint(game_map, moving, some, hits, images[part])
        return True
