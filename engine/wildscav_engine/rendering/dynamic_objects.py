"""What moves, as images show it: solids that know what they belong to and what they look like."""

from typing import Any

import numpy as np
from numba.extending import typeof_impl
from numpy.typing import NDArray

from wildscav_engine.rendering.tracing.solids import Solids


class DynamicObjects(Solids):
    """S solids, part by part, each of which belongs to an agent or a supply box."""

    instance: NDArray[np.int32]  # (S,) the seat of an agent, the serial number of a box
    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255

    def __new__(
        cls, solids: Solids, instance: NDArray[np.int32], color: NDArray[np.float64]
    ) -> "DynamicObjects":
        """Return solids with what is known about them besides."""
        objects = super().__new__(cls, *solids)
        objects.instance, objects.color = instance, color
        return objects

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.solids, self.instance, self.color)

    @property
    def solids(self) -> Solids:
        """The solids alone."""
        return Solids(*self)


@typeof_impl.register(DynamicObjects)
def _type_for_kernels(objects: DynamicObjects, context: Any) -> Any:
    """Let kernels take them for the solids that they are, so that none is compiled twice."""
    return typeof_impl(objects.solids, context)
