"""The code in kernels that reads arrays from tables of addresses; see ``array_tables.py``."""

import math
from typing import Any

import numba
from numba.core import cgutils, types
from numba.core.typing.templates import make_intrinsic_template

from wildscav_engine.compilation.passed_tables import COLUMNS
from wildscav_engine.compilation.table_type import make_array, pack, passed_type, write_table

# Annotated as Any, because Numba's stubs do not contain them.
typeof: Any = numba.typeof
named_tuple: Any = types.NamedTuple
alloca_once: Any = cgutils.alloca_once
make_template: Any = make_intrinsic_template
function_type: Any = types.Function

Arrays = Any  # a NamedTuple of arrays
Definition = Any  # a function from Numba types to a signature and a generator of code


def type_of(value: Any, definition: Definition) -> Any:
    """Return the type of a value that kernels call, whose code a definition generates.

    It is what Numba's ``intrinsic`` makes of a definition.
    """
    return function_type(make_template(value, definition, definition.__qualname__))


def _arrays_of(like: Arrays) -> Any:
    """Return the type of a NamedTuple of arrays, even if kernels get it as a table."""
    return named_tuple([typeof(array) for array in like], type(like))


def whole_reader(like: Arrays) -> Definition:
    """Return the definition of a kernel that reads all arrays of a table."""
    kind = _arrays_of(like)
    passed = passed_type(kind)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        table = _Table(context, builder, signature.args[0], arguments[0])
        if passed is not kind:
            return table.address(context.get_value_type(passed))
        arrays = []
        for field, array in enumerate(kind):
            shape = [table.number(field, 2 + axis) for axis in range(array.ndim)]
            arrays.append(pack(context, builder, array, table.number(field, 0), shape))
        return context.make_tuple(builder, kind, arrays)

    def read(typing_context: Any, table: Any) -> Any:  # noqa: ARG001
        return passed(table), generate

    return read


def row_reader(like: Arrays) -> Definition:
    """Return the definition of a kernel that reads one row of every array of a table."""
    arrays = [types.Array(array.dtype, array.ndim - 1, "C") for array in _arrays_of(like)]
    kind = named_tuple(arrays, type(like))
    passed = passed_type(kind)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        table = _Table(context, builder, signature.args[0], arguments[0])
        _, row, count = arguments
        found = []
        for field, array in enumerate(arrays):
            inner = [table.number(field, 4 + axis) for axis in range(array.ndim - 1)]
            offset = builder.mul(row, table.number(field, 1))
            for extent in [table.number(field, 3), *inner]:
                offset = builder.mul(offset, extent)
            found.append((builder.add(table.number(field, 0), offset), [count, *inner]))
        if passed is not kind:
            return write_table(context, builder, passed, found)
        packed = [pack(context, builder, array, *one) for array, one in zip(arrays, found, strict=True)]
        return context.make_tuple(builder, kind, packed)

    def read(typing_context: Any, table: Any, row: Any, count: Any) -> Any:  # noqa: ARG001
        return passed(table, types.int64, types.int64), generate

    return read


def number_reader(like: Any) -> Definition:
    """Return the definition of a kernel that converts (N,) float64 to a NamedTuple of numbers."""
    kind = typeof(like)

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

    return read


def values_reader(like: Arrays, names: tuple[str | tuple[str, ...], ...]) -> Definition:
    """Return the definition of a kernel that gathers the values of some fields in a row."""
    shapes = {name: array.shape[2:] for name, array in like._asdict().items()}

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays, row = arguments

        def load(name: str, place: int, kind: Any) -> Any:
            """Return code for one value of a field as a number of some kind."""
            inner = shapes[name]
            array = context.typing_context.resolve_getattr(signature.args[0], name)
            read = context.get_getattr(signature.args[0], name)
            data = make_array(array)(
                context, builder, read(context, builder, signature.args[0], arrays, name)
            ).data
            first = builder.mul(row, context.get_constant(types.intp, math.prod(inner)))
            item = builder.gep(data, [builder.add(first, context.get_constant(types.intp, place))])
            value = context.unpack_value(builder, array.dtype, item)
            return context.cast(builder, value, array.dtype, kind)

        found = []
        for name in names:
            if isinstance(name, tuple):
                bits = context.get_constant(types.int64, 0)
                for bit, flag in enumerate(name):
                    shift = context.get_constant(types.int64, bit)
                    bits = builder.or_(bits, builder.shl(load(flag, 0, types.int64), shift))
                found.append(context.cast(builder, bits, types.int64, types.float64))
            else:
                found += [load(name, place, types.float64) for place in range(math.prod(shapes[name]))]
        values = alloca_once(builder, context.get_value_type(types.float64), len(found))
        for place, value in enumerate(found):
            builder.store(value, builder.gep(values, [context.get_constant(types.intp, place)]))
        length = context.get_constant(types.intp, len(found))
        return pack(context, builder, signature.return_type, values, [length])

    def read(typing_context: Any, arrays: Any, row: Any) -> Any:  # noqa: ARG001
        return types.Array(types.float64, 1, "C")(arrays, types.int64), generate

    return read


def byte_reader() -> Definition:
    """Return the definition of a kernel that views memory as bytes."""
    return _read_bytes


def _generate_bytes(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return pack(context, builder, signature.return_type, arguments[0], [arguments[1]])


def _read_bytes(typing_context: Any, address: Any, size: Any) -> Any:  # noqa: ARG001
    return types.Array(types.uint8, 1, "C")(types.int64, types.int64), _generate_bytes


class _Table:
    """An array table in a kernel that is being compiled."""

    def __init__(self, context: Any, builder: Any, kind: Any, value: Any) -> None:
        self._context, self._builder = context, builder
        self._data = make_array(kind)(context, builder, value).data

    def number(self, row: int, column: int) -> Any:
        """Return code that reads one number of the table."""
        place = self._context.get_constant(types.intp, row * COLUMNS + column)
        return self._builder.load(self._builder.gep(self._data, [place]))

    def address(self, kind: Any) -> Any:
        """Return code for the address of the table."""
        return self._builder.bitcast(self._data, kind)
