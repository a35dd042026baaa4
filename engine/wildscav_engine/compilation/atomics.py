"""Numbers that several threads read and write at once, for kernels."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.core import cgutils, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import config

Numbers = NDArray[np.int64]
element_of: Any = cgutils.gep  # typed here, because Numba comes without types
BYTES = 8  # of a number


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return element_of(builder, array.data, arguments[1])


def _number_now(numbers: Numbers, index: int) -> int:
    return int(numbers[index])


def _generate_number_now(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load_atomic(_place(context, builder, signature, arguments), "acquire", BYTES)


def _type_number_now(typing_context: Any, numbers: Any, index: Any) -> Any:  # noqa: ARG001
    return types.int64(numbers, types.int64), _generate_number_now


def _tell(numbers: Numbers, index: int, number: int) -> int:
    numbers[index] = number
    return number


def _generate_tell(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    place = _place(context, builder, signature, arguments)
    builder.store_atomic(arguments[2], place, "release", BYTES)
    return arguments[2]


def _type_tell(typing_context: Any, numbers: Any, index: Any, number: Any) -> Any:  # noqa: ARG001
    return types.int64(numbers, types.int64, types.int64), _generate_tell


def _count_one(numbers: Numbers, index: int) -> int:
    numbers[index] += 1
    return int(numbers[index]) - 1


def _generate_count_one(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    place = _place(context, builder, signature, arguments)
    return builder.atomic_rmw("add", place, context.get_constant(types.int64, 1), "acq_rel")


def _type_count_one(typing_context: Any, numbers: Any, index: Any) -> Any:  # noqa: ARG001
    return types.int64(numbers, types.int64), _generate_count_one


def _raise_to(numbers: Numbers, index: int, number: int) -> int:
    before = int(numbers[index])
    numbers[index] = max(before, number)
    return before


def _generate_raise_to(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    place = _place(context, builder, signature, arguments)
    return builder.atomic_rmw("max", place, arguments[2], "acq_rel")


def _type_raise_to(typing_context: Any, numbers: Any, index: Any, number: Any) -> Any:  # noqa: ARG001
    return types.int64(numbers, types.int64, types.int64), _generate_raise_to


def _kernel(plain: Callable[..., int], typed: Callable[..., Any]) -> Callable[..., int]:
    generated: Any = intrinsic(typed)
    return plain if config.DISABLE_JIT else generated


# Returns one of some numbers (N,) as it is in memory now.
number_now: Callable[[Numbers, int], int] = _kernel(_number_now, _type_number_now)
# Writes one of some numbers, when all that was written before can be seen; returns it.
tell: Callable[[Numbers, int, int], int] = _kernel(_tell, _type_tell)
# Adds 1 to one of some numbers and returns what it was before: no two threads get the same.
count_one: Callable[[Numbers, int], int] = _kernel(_count_one, _type_count_one)
# Makes one of some numbers at least so large and returns what it was: of several, one raised it.
raise_to: Callable[[Numbers, int, int], int] = _kernel(_raise_to, _type_raise_to)
