"""The base classes of cameras: pinholes, with rays through the centres of square pixels.

Row 0 is at the top, column 0 at the left.
"""

from functools import cached_property, lru_cache
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.parallel.turns import Turns
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.images import Output, trace_images
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.image_sensor import ImageSensor, ShownMaps


@lru_cache(maxsize=64)
def _half_width(field_of_view: float) -> float:
    """Return the tangent of half a field of view in degrees."""
    return sine(field_of_view / 2.0) / cosine(field_of_view / 2.0)


@sensor
class PinholeCamera(ImageSensor):
    """A camera with its resolution, field of view and range."""

    width: Annotated[int, Field(ge=1, le=1920)] = 38  # pixels in a row
    height: Annotated[int, Field(ge=1, le=1080)] = 22  # rows of pixels
    far: Annotated[float, Field(ge=0.01, le=2000)] = 100.0  # m along the ray; nothing farther is seen
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


@sensor
class TracedCamera(PinholeCamera):
    """A camera whose pixels say what their rays hit."""

    output: ClassVar[Output]  # what the pixels say

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[Any],
        turns: Turns,
    ) -> bool:
        """Write the output of what the rays hit."""
        return trace_images(self.output, shown.scenes, objects, matches, cameras, images, turns)
