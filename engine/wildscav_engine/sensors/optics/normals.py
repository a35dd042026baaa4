"""The normals camera: the direction that the surface in each pixel faces.

Normals are unit vectors in the axes of the world (x east, y up, z north). They are zero where the ray hits
nothing within ``far``, or where it starts inside a solid. Rays pass through water to its bed. Agents and
supply boxes are invisible unless the option ``moving`` is set.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.parallel.turns import Turns
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.images import Output, trace_images
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.image_sensor import ShownMaps
from wildscav_engine.sensors.optics.pinhole import PinholeCamera


@sensor
class NormalCamera(PinholeCamera):
    """Unit normals."""

    name: ClassVar[str] = "normals"
    title: ClassVar[str] = "unit normals of surfaces, in the world's axes"
    dtype: ClassVar[type[np.generic]] = np.float32
    channels: ClassVar[tuple[int, ...]] = (3,)

    moving: bool = False  # whether agents and supply boxes are visible

    @property
    def bounds(self) -> tuple[float, float]:
        """-1 and 1."""
        return -1.0, 1.0

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[np.float32],
        turns: Turns,
    ) -> bool:
        """Write the normals of the surfaces that the rays hit."""
        return trace_images(Output.NORMALS, shown.scenes, objects, matches, cameras, images, turns)
