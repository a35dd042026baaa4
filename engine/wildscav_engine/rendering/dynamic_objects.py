"""Moving objects as images show them: solids with their instance and colour."""

from typing import Any

import numpy as np
from numba.extending import typeof_impl
from numpy.typing import NDArray

from wildscav_engine.rendering.tracing.solids import Solids


class DynamicObjects(Solids):
    """S solids, the parts of agents and supply boxes."""

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
        """The solids without instances and colours."""
        return Solids(*self)


@typeof_impl.register(DynamicObjects)
def _type_for_kernels(objects: DynamicObjects, context: Any) -> Any:
    """Make kernels treat them as ``Solids``, so that no kernel is compiled for two types."""
    return typeof_impl(objects.solids, context)
