"""Array tables: many arrays passed to a kernel as one small table of addresses and shapes.

A call from Python unpacks every array that it passes. A batch and its maps have about a hundred arrays, and
unpacking them takes longer than playing a step of many matches. Instead, the kernel unpacks them from a table
with a row of ``COLUMNS`` numbers for each array: its address, the size of an item in bytes, and its shape.
The caller must keep the arrays alive during the call; an ``ArrayTable`` does so.
"""

import ctypes
import math
from collections.abc import Callable
from typing import Any, TypeVar

import numba
import numba.np.arrayobj
import numpy as np
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import config

# Annotated as Any, because Numba's stubs do not contain them.
typeof: Any = numba.typeof
make_array: Any = numba.np.arrayobj.make_array
populate_array: Any = numba.np.arrayobj.populate_array
named_tuple: Any = types.NamedTuple

AXES = 4  # the largest number of axes of an array
COLUMNS = 2 + AXES

# (F, 6) address, bytes per item, and shape of each array, padded with 1 to four axes.
Addresses = NDArray[np.int64]
Function = TypeVar("Function", bound=Callable[..., Any])
Arrays = Any  # a NamedTuple of arrays


# For each NamedTuple class that kernels read from tables, an example with the right dtypes and axes.
_layouts: dict[type, Arrays] = {}


class ArrayTable:
    """A NamedTuple of arrays, which it keeps alive, and their table of addresses."""

    def __init__(self, arrays: Arrays) -> None:
        """Build the table of some arrays.

        Raises:
            TypeError: An array does not have the dtype or number of axes that kernels expect.
            ValueError: An array is not contiguous.
        """
        self.arrays = arrays
        self.addresses = addresses_of(arrays)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle only the arrays: the copies have other addresses."""
        return ArrayTable, (self.arrays,)


def expect(like: Arrays) -> None:
    """From now on, reject tables of this class whose arrays have other dtypes or numbers of axes."""
    _layouts[type(like)] = like


def addresses_of(arrays: Arrays) -> Addresses:
    """Return the (F, 6) table of contiguous arrays with at most four axes.

    Raises:
        TypeError: An array does not have the dtype or number of axes that kernels expect.
        ValueError: An array is not contiguous.
    """
    kind = type(arrays)
    layout: Arrays = _layouts.get(kind, arrays)
    rows = []
    for name, array, expected in zip(arrays._fields, arrays, layout, strict=True):
        if array.dtype != expected.dtype or array.ndim != expected.ndim:
            raise TypeError(
                f"{kind.__name__}.{name} is {array.dtype} with {array.ndim} axes, "
                f"must be {expected.dtype} with {expected.ndim}"
            )
        if not array.flags.c_contiguous:
            raise ValueError(f"{name} is not contiguous")
        shape = (*array.shape, *(1,) * (AXES - array.ndim))
        rows.append((array.__array_interface__["data"][0], array.itemsize, *shape))
    return np.array(rows, np.int64)


def _kernel(plain: Function, read: Callable[..., Any]) -> Function:
    """Return a code-generating function for kernels, or the plain one where kernels are plain Python."""
    generated: Any = intrinsic(read)
    return plain if config.DISABLE_JIT else generated


def reader(like: Arrays) -> Callable[[Addresses], Arrays]:
    """Return a kernel that reads all arrays of a table.

    Args:
        like: An example NamedTuple, with the dtypes and numbers of axes of the arrays to be read.
    """
    expect(like)
    kind = typeof(like)

    def whole(table: Addresses) -> Arrays:
        shapes = [row[2 : 2 + array.ndim] for row, array in zip(table, like, strict=True)]
        return type(like)(*map(_array_at, table[:, 0], shapes, [array.dtype for array in like]))

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        table = _Table(context, builder, signature.args[0], arguments[0])
        arrays = []
        for field, array in enumerate(kind):
            shape = [table.number(field, 2 + axis) for axis in range(array.ndim)]
            arrays.append(_pack(context, builder, array, table.number(field, 0), shape))
        return context.make_tuple(builder, kind, arrays)

    def read(typing_context: Any, table: Any) -> Any:  # noqa: ARG001
        return kind(table), generate

    return _kernel(whole, read)


def row_reader(like: Arrays) -> Callable[[Addresses, int, int], Arrays]:
    """Return a kernel that reads one row of every array of a table, without the padding at its end.

    Its arguments are the table, the index on the first axis, and the used length of the second axis.

    Args:
        like: An example NamedTuple, with the dtypes and numbers of axes of the arrays to be read.
    """
    expect(like)
    arrays = [types.Array(array.dtype, array.ndim - 1, "C") for array in typeof(like)]
    kind = named_tuple(arrays, type(like))

    def row_of(table: Addresses, row: int, count: int) -> Arrays:
        found = []
        for (address, itemsize, _, *inner), array in zip(table, like, strict=True):
            shape = (count, *inner[1 : array.ndim - 1])
            found.append(_array_at(address + row * itemsize * math.prod(inner), shape, array.dtype))
        return type(like)(*found)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        table = _Table(context, builder, signature.args[0], arguments[0])
        _, row, count = arguments
        found = []
        for field, array in enumerate(arrays):
            inner = [table.number(field, 4 + axis) for axis in range(array.ndim - 1)]
            offset = builder.mul(row, table.number(field, 1))
            for extent in [table.number(field, 3), *inner]:
                offset = builder.mul(offset, extent)
            address = builder.add(table.number(field, 0), offset)
            found.append(_pack(context, builder, array, address, [count, *inner]))
        return context.make_tuple(builder, kind, found)

    def read(typing_context: Any, table: Any, row: Any, count: Any) -> Any:  # noqa: ARG001
        return kind(table, types.int64, types.int64), generate

    return _kernel(row_of, read)


def number_reader(like: Any) -> Callable[[NDArray[np.float64]], Any]:
    """Return a kernel that converts (N,) float64 to a NamedTuple of numbers.

    Args:
        like: An example NamedTuple of numbers; its integer fields are read as integers.
    """
    kind = typeof(like)

    def numbers(values: NDArray[np.float64]) -> Any:
        return type(like)(*(type(number)(value) for number, value in zip(like, values, strict=True)))

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        table = _Table(context, builder, signature.args[0], arguments[0])
        found = []
        for field, number in enumerate(kind):
            value = table.number(0, field)
            whole = isinstance(number, types.Integer)
            found.append(builder.fptosi(value, context.get_value_type(number)) if whole else value)
        return context.make_tuple(builder, kind, found)

    def read(typing_context: Any, values: Any) -> Any:  # noqa: ARG001
        return kind(values), generate

    return _kernel(numbers, read)


def _bytes_at(address: int, size: int) -> NDArray[np.uint8]:
    return _array_at(address, (size,), np.dtype(np.uint8))


def _generate_bytes(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _pack(context, builder, signature.return_type, arguments[0], [arguments[1]])


def _read_bytes(typing_context: Any, address: Any, size: Any) -> Any:  # noqa: ARG001
    return types.Array(types.uint8, 1, "C")(types.int64, types.int64), _generate_bytes


# In kernels, returns (size,) bytes that begin at an address, as a view.
bytes_at: Callable[[int, int], NDArray[np.uint8]] = _kernel(_bytes_at, _read_bytes)


class _Table:
    """An array table in a kernel that is being compiled."""

    def __init__(self, context: Any, builder: Any, kind: Any, value: Any) -> None:
        self._context, self._builder = context, builder
        self._data = make_array(kind)(context, builder, value).data

    def number(self, row: int, column: int) -> Any:
        """Return code that reads one number of the table."""
        place = self._context.get_constant(types.intp, row * COLUMNS + column)
        return self._builder.load(self._builder.gep(self._data, [place]))


def _pack(context: Any, builder: Any, kind: Any, address: Any, shape: list[Any]) -> Any:
    """Return code for an array with a given address and shape, without reference counting."""
    array = make_array(kind)(context, builder)
    itemsize = context.get_constant(types.intp, context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    strides = [itemsize]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent))
    data = builder.inttoptr(address, array.data.type)
    populate_array(array, data=data, shape=shape, strides=strides, itemsize=itemsize, meminfo=None)
    return array._getvalue()


def _array_at(address: int, shape: Any, dtype: Any) -> NDArray[Any]:
    """Return the array with a given address and shape, where kernels are plain Python."""
    size = math.prod(int(extent) for extent in shape) * dtype.itemsize
    if size == 0:
        return np.zeros(shape, dtype)
    memory = (ctypes.c_char * size).from_address(int(address))
    return np.frombuffer(memory, dtype).reshape(shape)
