"""The segmentation camera: the kind or the identity of the object in each pixel.

Labels by ``kind`` are the numbers of ``Kind``: 0 nothing, 1 terrain, 2 water, 3 wall, … 11 bush, 12 agent,
13 supply box. Labels by ``instance`` distinguish objects of the same kind: 0 is nothing, 1 terrain and 2
water. Agents are numbered from ``FIRST_AGENT`` on by seat, solids of the map from ``FIRST_SOLID`` on by
index, and supply boxes from ``FIRST_BOX`` on by serial number. A wall with a door consists of several solids.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np

from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.images import FIRST_AGENT, FIRST_BOX, FIRST_SOLID, Output
from wildscav_engine.sensors.base import Sensor, sensor
from wildscav_engine.sensors.optics.pinhole import TracedCamera

__all__ = ["FIRST_AGENT", "FIRST_BOX", "FIRST_SOLID", "SegmentationCamera"]

MAX_LABEL = 2**31 - 1


@sensor
class SegmentationCamera(TracedCamera):
    """Labels of the objects in each pixel."""

    label: Literal["kind", "instance"] = "kind"  # what the value of a pixel means

    name: ClassVar[str] = "segmentation"
    title: ClassVar[str] = "the object in each pixel: number of its kind, or of its instance"

    @classmethod
    def warmers(cls) -> Sequence[Sensor]:
        """Return one sensor for each label, because their dtypes differ."""
        return (cls(), cls(label="instance"))

    @property
    def dtype(self) -> type[np.generic]:  # type: ignore[override]
        """The dtype of the labels."""
        return np.uint8 if self.label == "kind" else np.int32

    @property
    def sees_objects(self) -> bool:
        """Always."""
        return True

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the greatest label."""
        return 0, max(Kind) if self.label == "kind" else MAX_LABEL

    @property
    def output(self) -> Output:  # type: ignore[override]
        """The labels of kinds, or of instances."""
        return Output.INSTANCES if self.label == "instance" else Output.KINDS
