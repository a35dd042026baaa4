"""Moving objects as images show them: solids with their instance and colour."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.rendering.tracing.packing import Packed, pack_shapes
from wildscav_engine.rendering.tracing.solids import Solids, all_shapes_of


class DynamicObjects(Solids):
    """S solids, the parts of agents and supply boxes; nobody changes them once an image shows them."""

    instance: NDArray[np.int32]  # (S,) the seat of an agent, the serial number of a box
    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255

    def __new__(
        cls, solids: Solids, instance: NDArray[np.int32], color: NDArray[np.float64]
    ) -> "DynamicObjects":
        """Return solids together with their instances and colours."""
        objects = super().__new__(cls, *solids)
        objects.instance, objects.color = instance, color
        return objects

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.solids, self.instance, self.color)

    @property
    def solids(self) -> Solids:
        """The solids without instances and colours, as kernels read them.

        A kernel that read these objects themselves would be compiled once more, for another type.
        """
        return Solids(*self)

    @cached_property
    def packed(self) -> Packed:
        """The solids in the form for tracing, for all images that show these objects."""
        return pack_shapes(all_shapes_of(self.solids))
