"""The normals camera: the direction that the surface in each pixel faces.

Normals are unit vectors in the axes of the world (x east, y up, z north). They are zero where the ray hits
nothing within ``far``, or where it starts inside a solid. Rays pass through water to its bed. Agents and
supply boxes are invisible unless the option ``moving`` is set.
"""

from typing import ClassVar

import numpy as np

from wildscav_engine.rendering.images import Output
from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.pinhole import TracedCamera


@sensor
class NormalCamera(TracedCamera):
    """Unit normals."""

    name: ClassVar[str] = "normals"
    title: ClassVar[str] = "unit normals of surfaces, in the world's axes"
    dtype: ClassVar[type[np.generic]] = np.float32
    channels: ClassVar[tuple[int, ...]] = (3,)
    output: ClassVar[Output] = Output.NORMALS

    moving: bool = False  # whether agents and supply boxes are visible

    @property
    def bounds(self) -> tuple[float, float]:
        """-1 and 1."""
        return -1.0, 1.0
