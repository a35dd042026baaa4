"""The decorators of compiled functions.

A kernel is compiled when it is first called, and the compiler itself is imported only then: a program that
imports the engine for its names and formats starts in a fraction of the time that Numba takes to load. What
is compiled, and with which options, is in ``compiler.py``.
"""

import functools
import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np

Params = ParamSpec("Params")
Returned = TypeVar("Returned")


def _is_plain() -> bool:
    try:
        return int(os.environ.get("NUMBA_DISABLE_JIT", "0")) != 0
    except ValueError:
        return False


# Whether kernels are plain Python, for debuggers; Numba reads the same variable.
PLAIN = _is_plain()


class Kernel:
    """A compiled function, compiled separately for calls from kernels and for calls from Python.

    Most kernels are only called by other kernels. Machine code of their own and the wrapper that converts
    arguments from Python would take longer to compile than the kernels themselves, so both are made only when
    Python calls the kernel.
    """

    def __init__(
        self, function: Callable[..., Any], home: Callable[..., Any] | None = None, **options: bool
    ) -> None:
        functools.update_wrapper(self, function)
        self._function, self._home, self._options = function, home or function, options

    @functools.cached_property
    def inner(self) -> Any:
        """The function for calls from kernels."""
        return self._made("inner")

    @functools.cached_property
    def outer(self) -> Any:
        """The function for calls from Python."""
        return self._made("outer")

    def __call__(self, *arguments: Any) -> Any:
        """Call the kernel from Python."""
        return self.outer(*arguments)

    @property
    def _numba_type_(self) -> Any:
        """What the kernel is for kernels that call it."""
        return self.inner._numba_type_

    def __reduce__(self) -> str:
        """Copy and pickle the kernel as its function is: by its name."""
        return str(vars(self)["__qualname__"])

    def _made(self, name: str) -> Any:
        from wildscav_engine.compilation import compiler

        with compiler.global_compiler_lock:  # one function for all threads
            if name not in vars(self):
                compile_function = {"inner": compiler.compile_inner, "outer": compiler.compile_outer}[name]
                vars(self)[name] = compile_function(self._function, self._home, **self._options)
            return vars(self)[name]


def _compiled(
    function: Callable[Params, Returned], home: Callable[..., Any] | None = None, **options: bool
) -> Callable[Params, Returned]:
    return function if PLAIN else cast(Callable[Params, Returned], Kernel(function, home, **options))


def kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function that neither creates nor returns arrays; it reads and writes those it is given.

    Such a function needs no reference counting, which would cost more than most kernels do: a world and the
    agents of a match are about forty arrays. Creating an array in it is a compile-time error.
    """
    return _compiled(function, _nrt=False)


def inlined_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function like ``kernel``, and inline it into every kernel that calls it.

    A call passes every number and every array's shape, strides and address one by one. For small functions
    with large tuples as arguments, that costs more than the function itself.
    """
    return _compiled(function, _nrt=False, forceinline=True)


def disjoint_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function like ``kernel`` whose array arguments never share memory.

    Loops that read some arrays and write others then vectorize in every kernel that calls it. Otherwise the
    compiler would add checks for shared memory, and whether these let the fast loop run depends on what else
    is inlined around it. As the compiler relies on this, wrong results follow if two arrays do share memory.
    """
    return _compiled(function, _nrt=False, disjoint=True)


def array_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function that creates or returns arrays, including views."""
    return _compiled(function)


def kernel_beside(
    other: Callable[..., Any], function: Callable[Params, Returned]
) -> Callable[Params, Returned]:
    """Compile a function like ``kernel`` that is made for another kernel, which it calls.

    It counts as part of that kernel's file, so that both are always compiled again together.
    """
    return _compiled(function, plain(other), _nrt=False)


def plain(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Return the function that a kernel was made of, for calls from Python that are not worth compiling."""
    return function if PLAIN else cast(Kernel, function)._function


def specialize(function: Callable[..., Returned], *examples: Any) -> Callable[..., Returned]:
    """Return a kernel with the least overhead for calls from Python: it accepts only one signature.

    This saves half a microsecond per call, and the caller need not check its arguments: any other type raises
    TypeError or NumbaError, and no code is compiled for it. The types are those of the examples.
    """
    if PLAIN:
        return _specialize(function, [_argument_type(example) for example in examples])
    from wildscav_engine.compilation.compiler import typeof

    compiled = cast(Kernel, function).outer
    compiled.compile(tuple(typeof(example) for example in examples))
    compiled.disable_compile()
    return cast(Callable[..., Returned], compiled)


def argument_error() -> type[Exception]:
    """Return the class of errors that kernels raise for arguments of other types: NumbaError."""
    from numba.core.errors import NumbaError

    return NumbaError


def _specialize(function: Callable[..., Returned], types: list[Any]) -> Callable[..., Returned]:
    """Do the same as ``specialize`` where kernels are plain Python."""

    def call(*arguments: Any) -> Returned:
        if [_argument_type(argument) for argument in arguments] != types:
            raise TypeError(f"{function.__name__} takes {types}")
        return function(*arguments)

    return call


def _argument_type(value: Any) -> Any:
    return (value.dtype, value.ndim) if isinstance(value, np.ndarray) else type(value)
