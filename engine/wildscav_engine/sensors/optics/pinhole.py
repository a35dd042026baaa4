"""The base classes of cameras: pinholes, with rays through the centres of square pixels.

Row 0 is at the top, column 0 at the left.
"""

import threading
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
from wildscav_engine.sensors.optics.optical import OpticalSensor, select_cameras

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap


MAX_RAYS_AT_ONCE = 2**17  # whose hits stay in the cache until they become pixels
MOST_KEPT = 2**18  # rays whose hits are kept for the next images


class LatestHits(threading.local):
    """The hits that each thread wrote last, kept because fresh memory takes longer than used one."""

    def __init__(self) -> None:
        self._hits = allocate_hits(0, 0, 0)

    def of(self, most: int, count: int, height: int, width: int) -> Hits:
        """Return space for the hits of ``count`` images, out of that for ``most`` of them."""
        hits = self._hits
        if hits.distance.shape[1:] != (height, width) or len(hits.distance) < count:
            hits = allocate_hits(most, height, width)
            if most * height * width <= MOST_KEPT:
                self._hits = hits
        if len(hits.distance) == count:
            return hits
        return Hits(hits.distance[:count], hits.solid[:count], hits.face[:count])


latest_hits = LatestHits()


@lru_cache(maxsize=64)
def _half_width(field_of_view: float) -> float:
    """Return the tangent of half a field of view in degrees."""
    return sine(field_of_view / 2.0) / cosine(field_of_view / 2.0)


@sensor
class PinholeCamera(OpticalSensor):
    """A camera with its resolution, field of view and range."""

    width: Annotated[int, Field(ge=1, le=1920)] = 38  # pixels
    height: Annotated[int, Field(ge=1, le=1080)] = 22  # pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 100.0  # m along the ray, its range
    field_of_view: Annotated[float, Field(ge=1, le=170)] = 60.0  # degrees, horizontally

    channels: ClassVar[tuple[int, ...]] = ()  # lengths of the axes after height and width

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape of one image."""
        return (self.height, self.width, *self.channels)

    @cached_property
    def lens(self) -> tuple[float, float]:
        """The tangent of half the field of view, and ``far``."""
        return _half_width(self.field_of_view), self.far


class RayHitCamera(PinholeCamera):
    """A camera that computes its pixels from what their rays hit (``write_pixels``)."""

    sees_water: ClassVar[bool] = False  # whether water stops rays; otherwise they reach its bed

    @abstractmethod
    def write_pixels(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, hits: Hits, images: NDArray[Any]
    ) -> None:
        """Compute pixels from what their rays hit.

        Args:
            game_map: The map.
            moving: The dynamic objects.
            cameras: N cameras.
            hits: The hits of N images.
            images: (N, *shape), written.
        """

    def render_into(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[Any]
    ) -> bool:
        """Render the images of some cameras."""
        # A few images at a time, because the hits of all rays take more memory than the images.
        batch_size = max(1, MAX_RAYS_AT_ONCE // (self.height * self.width))
        if batch_size >= len(images):
            return self._render_part(game_map, moving, cameras, len(images), images)
        parts = [slice(first, first + batch_size) for first in range(0, len(images), batch_size)]
        return all(
            self._render_part(game_map, moving, select_cameras(cameras, part), batch_size, images[part])
            for part in parts
        )

    def _render_part(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, most: int, images: NDArray[Any]
    ) -> bool:
        """Render the images of some cameras at once; ``most`` is the greatest number of images at once."""
        hits = latest_hits.of(most, len(images), self.height, self.width)
        if not trace(game_map.scene, moving, cameras, hits, with_water=self.sees_water):
            return False
        self.write_pixels(game_map, moving, cameras, hits, images)
        return True
