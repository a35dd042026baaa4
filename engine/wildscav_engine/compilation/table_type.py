"""What kernels pass to each other instead of many arrays: the address of their table.

Of a NamedTuple of arrays, Numba would pass every number and address of every array at each call: hundreds of
arguments for the agents of a match, most of which no kernel reads. This type is a single pointer, and kernels
read from the table only what they name. Classes become such tables by ``pass_as_table``.
"""

from typing import Any

import llvmlite.ir
import numba.core.cgutils
import numba.core.datamodel
import numba.np.arrayobj
from numba.core import imputils, pythonapi, types
from numba.core.typing import templates, typeof

from wildscav_engine.compilation.passed_tables import ADDRESS, COLUMNS, ROWS, is_passed_as_table

# Annotated as Any, because Numba has no types for them.
ir: Any = llvmlite.ir
cgutils: Any = numba.core.cgutils
datamodel: Any = numba.core.datamodel
Type: Any = types.Type
make_array: Any = numba.np.arrayobj.make_array
populate_array: Any = numba.np.arrayobj.populate_array
array_type: Any = types.Array
named_tuple: Any = types.NamedTuple
NativeValue: Any = pythonapi.NativeValue
AttributeTemplate: Any = templates.AttributeTemplate
builtin_registry: Any = imputils.builtin_registry
unbox: Any = pythonapi.unbox
typeof_tuple: Any = typeof.typeof_impl.dispatch(tuple)

ROW = ir.ArrayType(ir.IntType(64), COLUMNS)


def pack(context: Any, builder: Any, kind: Any, address: Any, shape: list[Any]) -> Any:
    """Return code for an array with a given address or pointer, and shape, without reference counting."""
    array = make_array(kind)(context, builder)
    itemsize = context.get_constant(types.intp, context.get_abi_sizeof(context.get_data_type(kind.dtype)))
    strides = [itemsize]
    for extent in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], extent))
    is_address = isinstance(address.type, ir.IntType)
    data = builder.inttoptr(address, array.data.type) if is_address else address
    populate_array(array, data=data, shape=shape, strides=strides, itemsize=itemsize, meminfo=None)
    return array._getvalue()


class TableType(Type):  # type: ignore[misc]
    """The type of a table of arrays in kernels."""

    def __init__(self, arrays: Any) -> None:
        """Describe a table by the type of a NamedTuple of its arrays, which are contiguous and in C order."""
        self.arrays = arrays
        super().__init__(f"Table({arrays})")


def passed_type(arrays: Any) -> Any:
    """Return what kernels get for arrays of the type of a NamedTuple: a table, if its class is one."""
    return TableType(arrays) if is_passed_as_table(arrays.instance_class) else arrays


@typeof.typeof_impl.register(tuple)
def _type_of_tuple(value: Any, context: Any) -> Any:
    found = typeof_tuple(value, context)
    if not is_passed_as_table(type(value)):
        return found
    arrays = [array_type(array.dtype, array.ndim, "C") for array in found]
    is_plain = all(array.layout == "C" and array.aligned for array in found)
    return TableType(named_tuple(arrays, type(value))) if is_plain else found


@datamodel.register_default(TableType)
class TableModel(datamodel.models.PrimitiveModel):  # type: ignore[misc]
    """A table in machine code: its address."""

    def __init__(self, manager: Any, kind: TableType) -> None:
        super().__init__(manager, kind, ir.ArrayType(ROW, len(kind.arrays)).as_pointer())


@templates.infer_getattr
class TableAttributes(AttributeTemplate):  # type: ignore[misc]
    """The fields of a table."""

    key = TableType

    def generic_resolve(self, table: TableType, name: str) -> Any:
        """Return the type of a field."""
        fields = table.arrays.fields
        return table.arrays[fields.index(name)] if name in fields else None


def _read_field(context: Any, builder: Any, kind: TableType, table: Any, name: str) -> Any:
    """Return code that reads one array of a table."""
    field = kind.arrays.fields.index(name)
    array = kind.arrays[field]

    def number(column: int) -> Any:
        return builder.load(cgutils.gep_inbounds(builder, table, 0, field, column))

    shape = [number(ROWS + axis) for axis in range(array.ndim)]
    return pack(context, builder, array, number(ADDRESS), shape)


def write_table(context: Any, builder: Any, kind: TableType, rows: list[tuple[Any, list[Any]]]) -> Any:
    """Return code that writes the address and the shape of each array to a table of the calling function."""
    table = cgutils.alloca_once(builder, context.get_value_type(kind).pointee)
    for field, (address, shape) in enumerate(rows):
        for column, number in ((ADDRESS, address), *enumerate(shape, ROWS)):
            builder.store(number, cgutils.gep_inbounds(builder, table, 0, field, column))
    return table


def _from_python(kind: TableType, value: Any, python: Any) -> Any:
    """Return code that makes a table of a NamedTuple of arrays."""
    unboxed = python.unbox(kind.arrays, value)
    rows = []
    for field, array in enumerate(kind.arrays):
        item = python.builder.extract_value(unboxed.value, field)
        item = python.context.make_array(array)(python.context, python.builder, item)
        address = python.builder.ptrtoint(item.data, ir.IntType(64))
        rows.append((address, cgutils.unpack_tuple(python.builder, item.shape)))
    table = write_table(python.context, python.builder, kind, rows)
    return NativeValue(table, is_error=unboxed.is_error, cleanup=unboxed.cleanup)


def mark_tables(module: Any) -> None:
    """Tell the compiler that nothing writes to tables while kernels read them, and how large they are."""
    for function in module.functions:
        for argument in function.args:
            table = getattr(argument.type, "pointee", None)
            if isinstance(table, ir.ArrayType) and table.element == ROW:
                argument.add_attribute("noalias")
                argument.add_attribute("captures(none)")
                argument.attributes.dereferenceable = table.count * COLUMNS * 8


builtin_registry.lower_getattr_generic(TableType)(_read_field)
unbox(TableType)(_from_python)
