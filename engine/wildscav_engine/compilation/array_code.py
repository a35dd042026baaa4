"""The code in kernels for an array of which the address and the shape are known."""

from typing import Any

import numba.np.arrayobj
from llvmlite import ir
from numba.core import types

# Annotated as Any, because Numba's stubs do not contain them.
make_array: Any = numba.np.arrayobj.make_array
populate_array: Any = numba.np.arrayobj.populate_array


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
