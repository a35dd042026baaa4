"""Moving objects as images show them: solids with their instance and colour."""

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel, plain
from wildscav_engine.compilation.passed_tables import ADDRESS, COLUMNS, ITEM, ROWS
from wildscav_engine.compilation.tables.array_tables import Addresses, addresses_of, reader
from wildscav_engine.rendering.tracing.scene_arrays import Shapes
from wildscav_engine.rendering.tracing.solids import Solids, all_shapes_of, gather_solids


class ObjectArrays(NamedTuple):
    """S solids in the forms for tracing and for shading; see ``Solids`` and ``Shapes``."""

    kind: NDArray[np.int8]
    owner: NDArray[np.int32]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    face_start: NDArray[np.int64]
    faces: NDArray[np.float64]
    corner_start: NDArray[np.int64]
    corners: NDArray[np.float64]
    obbs: NDArray[np.float64]
    names: NDArray[np.int64]
    color: NDArray[np.float64]  # (S, 3) red, green, blue 0-255
    instance: NDArray[np.int32]  # (S,) the seat of an agent, the serial number of a box


class ObjectSets:
    """The moving objects of M matches, one match after another.

    Attributes:
        arrays: All objects; there may be room for further ones behind them.
        start: (M + 1,) where the objects of each match start.
        most: The number of objects of the match that has most.
        most_faces: The number of faces of the object that has most.
        addresses: (12, 6) the table of the arrays of all objects, for ``read_objects``.
    """

    def __init__(
        self,
        arrays: ObjectArrays,
        start: NDArray[np.int64],
        most: int,
        most_faces: int,
        addresses: Addresses | None = None,
    ) -> None:
        """Collect what kernels need; without ``addresses``, build the table.

        Raises:
            TypeError: The table is to be built, and an array does not have the dtype or number of axes that
                kernels expect.
            ValueError: The same, and an array is not contiguous.
        """
        self.arrays, self.start, self.most, self.most_faces = arrays, start, most, most_faces
        self.addresses = addresses_of(arrays) if addresses is None else addresses

    def solids_of(self, match: int) -> Solids:
        """Return the objects of a match, as views."""
        return plain(solids_between)(self.arrays, self.start[match], self.start[match + 1])

    def __reduce__(self) -> tuple[type["ObjectSets"], tuple[Any, ...]]:
        """Copy and pickle all but the table: copies have other addresses."""
        return ObjectSets, (self.arrays, self.start, self.most, self.most_faces)


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

    @classmethod
    def of(cls, sets: ObjectSets) -> "DynamicObjects":
        """Return the objects of a single match."""
        arrays, starts = sets.arrays, sets.arrays.face_start
        objects = cls(sets.solids_of(0), arrays.instance, arrays.color)
        objects.shapes = Shapes(arrays.obbs, starts, arrays.faces, arrays.names, starts[:-1])
        objects.sets = sets
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
    def shapes(self) -> Shapes:
        """The solids as they are traced."""
        return all_shapes_of(self.solids)

    @cached_property
    def sets(self) -> ObjectSets:
        """The objects as those of one match."""
        return _in_one_set(self.solids, self.shapes, self.color, self.instance)


def sets_of(solids: Solids) -> ObjectSets:
    """Return solids as the objects of one match; unless they are ``DynamicObjects``, they are black."""
    if isinstance(solids, DynamicObjects):
        return solids.sets
    count = len(solids.kind)
    return _in_one_set(solids, all_shapes_of(solids), np.zeros((count, 3)), np.zeros(count, np.int32))


def _in_one_set(
    solids: Solids, shapes: Shapes, color: NDArray[np.float64], instance: NDArray[np.int32]
) -> ObjectSets:
    arrays = ObjectArrays(*solids, shapes.obbs, shapes.names, color, instance)
    most_faces = int(np.diff(solids.face_start).max(initial=0))
    return ObjectSets(arrays, np.array([0, len(solids.kind)]), len(solids.kind), most_faces)


def addresses_of_new(arrays: ObjectArrays) -> Addresses:
    """Return the same as ``addresses_of`` in a tenth of its time, without its checks: of arrays just made."""
    addresses = np.empty((len(arrays), COLUMNS), np.int64)
    _write_addresses(addresses, *arrays)
    return addresses


@kernel
def _write_addresses(table: Addresses, *arrays: NDArray[Any]) -> None:
    # One by one, because the types differ.
    _write_address(arrays[0], table[0])
    _write_address(arrays[1], table[1])
    _write_address(arrays[2], table[2])
    _write_address(arrays[3], table[3])
    _write_address(arrays[4], table[4])
    _write_address(arrays[5], table[5])
    _write_address(arrays[6], table[6])
    _write_address(arrays[7], table[7])
    _write_address(arrays[8], table[8])
    _write_address(arrays[9], table[9])
    _write_address(arrays[10], table[10])
    _write_address(arrays[11], table[11])


@inlined_kernel
def _write_address(array: NDArray[Any], row: NDArray[np.int64]) -> None:
    row[:] = 1
    row[ADDRESS], row[ITEM] = array.ctypes.data, array.itemsize
    for axis in range(array.ndim):
        row[ROWS + axis] = array.shape[axis]


# A kernel that returns the arrays of ``ObjectSets`` from their table.
read_objects = reader(
    ObjectArrays(
        *gather_solids([]),
        obbs=np.zeros((0, 9)),
        names=np.zeros(0, np.int64),
        color=np.zeros((0, 3)),
        instance=np.zeros(0, np.int32),
    )
)


@inlined_kernel
def solids_between(objects: ObjectArrays, first: int, last: int) -> Solids:
    """Return the objects from one index to before another, as views."""
    return Solids(
        objects.kind[first:last],
        objects.owner[first:last],
        objects.low[first:last],
        objects.high[first:last],
        objects.face_start[first : last + 1],
        objects.faces,
        objects.corner_start[first : last + 1],
        objects.corners,
    )


@inlined_kernel
def shapes_between(objects: ObjectArrays, first: int, last: int) -> Shapes:
    """Return the same objects in the form for tracing."""
    return Shapes(
        objects.obbs[first:last],
        objects.face_start[first : last + 1],
        objects.faces,
        objects.names[first:last],
        objects.face_start[first:last],
    )
