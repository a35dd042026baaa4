"""The decorators of compiled functions.

Numba compiles kernels for exactness first: no ``fastmath`` (replays must match bit for bit) and divisions as
in IEEE 754. Kernels release the GIL, because the server and batches run them in threads.

Compiled code is cached on disk for every process that runs the same sources, whatever their location
(see ``kernel_cache.py``). The traceback of an error in a kernel names the files that were compiled.
"""

import functools
import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
import numpy as np
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import typeof_impl

from wildscav_engine.compilation.cache_folders import cache_folder
from wildscav_engine.compilation.kernel_cache import KernelCache
from wildscav_engine.compilation.linking import PartCache, PartCompiler, WholeCompiler, for_all_numbers
from wildscav_engine.compilation.locks import locked
from wildscav_engine.compilation.notice import notice

Params = ParamSpec("Params")
Returned = TypeVar("Returned")

# Annotated as Any, because Numba has settings and options that its type stubs do not contain.
config: Any = numba.config
njit: Any = numba.njit
typeof: Any = numba.typeof

GC_THRESHOLDS = (100_000, 50, 1000)  # as in ``gc.set_threshold``
EXACT_OPTIONS = {"fastmath": False, "nogil": True, "error_model": "numpy"}


class Kernel:
    """A compiled function, compiled separately for calls from kernels and for calls from Python.

    Most kernels are only called by other kernels. Machine code of their own and the wrapper that converts
    arguments from Python would take longer to compile than the kernels themselves, so both are made only when
    Python calls the kernel.
    """

    def __init__(self, function: Callable[..., Any], **options: bool) -> None:
        self.inner = _compile_part(function, **options)
        self.outer = _compile(function, no_cfunc_wrapper=True, **options)
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call the kernel from Python."""
        return self.outer(*arguments)


@typeof_impl.register(Kernel)
def _type_for_other_kernels(value: Kernel, context: Any) -> Any:
    return typeof_impl(value.inner, context)


def kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function that neither creates nor returns arrays; it reads and writes those it is given.

    Such a function needs no reference counting, which would cost more than most kernels do: a world and the
    agents of a match are about forty arrays. Creating an array in it is a compile-time error.
    """
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function, _nrt=False))


def inlined_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function like ``kernel``, and inline it into every kernel that calls it.

    A call passes every number and every array's shape, strides and address one by one. For small functions
    with large tuples as arguments, that costs more than the function itself.
    """
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function, _nrt=False, forceinline=True))


def array_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function that creates or returns arrays, including views."""
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function))


def only_for(function: Callable[..., Returned], *examples: Any) -> Callable[..., Returned]:
    """Return a kernel with the least overhead for calls from Python: it accepts only one signature.

    This saves half a microsecond per call, and the caller need not check its arguments: any other type raises
    TypeError or NumbaError, and no code is compiled for it.

    Args:
        function: A kernel.
        examples: An example of each argument, with the type that the kernel accepts.
    """
    if config.DISABLE_JIT:
        return _only_for(function, [_argument_type(example) for example in examples])
    compiled = cast(Kernel, function).outer
    compiled.compile(tuple(typeof(example) for example in examples))
    compiled.disable_compile()
    return cast(Callable[..., Returned], compiled)


def _only_for(function: Callable[..., Returned], types: list[Any]) -> Callable[..., Returned]:
    """Do the same as ``only_for`` where kernels are plain Python."""

    def call(*arguments: Any) -> Returned:
        if [_argument_type(argument) for argument in arguments] != types:
            raise TypeError(f"{function.__name__} takes {types}")
        return function(*arguments)

    return call


def _argument_type(value: Any) -> Any:
    return (value.dtype, value.ndim) if isinstance(value, np.ndarray) else type(value)


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    folder = _folder_of(function, "-".join(sorted(options)) or "plain")
    # Without reference counting, no second pass is needed to find references that can be removed.
    whole = {} if options.get("_nrt", True) else {"pipeline_class": WholeCompiler}
    return _with_cache(njit(**EXACT_OPTIONS, **options, **whole)(function), KernelCache(function, folder))


def _compile_part(function: Callable[..., Any], **options: bool) -> Any:
    """Compile a function only for calls from kernels."""
    folder = _folder_of(function, "-".join(["part", *sorted(options)]))
    part = njit(
        pipeline_class=PartCompiler,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        **EXACT_OPTIONS,
        **options,
    )(function)
    return _with_cache(for_all_numbers(part), PartCache(function, folder))


def _folder_of(function: Callable[..., Any], options: str) -> Path:
    # Numba does not distinguish code compiled with different options, so each set has a folder of its own.
    return cache_folder(Path(function.__code__.co_filename)) / options


def _with_cache(dispatcher: Any, cache: KernelCache) -> Any:
    """Cache the compiled code of a function on disk and compile it in one process at a time; return it.

    Two processes that compiled the same function at once would both compile everything that it calls, and
    could mix up their cached files, because Numba numbers the files of a function's signatures
    consecutively. There are no deadlocks: a process that waits for a kernel holds locks only on callers of
    that kernel.
    """
    compile_unlocked = dispatcher.compile
    lock = Path(cache.cache_path) / f"{dispatcher.py_func.__qualname__}.lock"

    def compile_locked(signature: Any) -> Any:
        with (
            global_compiler_lock,
            notice.waiting(),
            locked(lock, lambda: notice.begin(0)),
            _rare_garbage_collection(),
        ):
            return compile_unlocked(signature)

    dispatcher._cache = cache
    dispatcher.compile = compile_locked
    return dispatcher


@contextmanager
def _rare_garbage_collection() -> Iterator[None]:
    """Run Python's garbage collector less often.

    A compiler creates very many long-lived objects; scanning all of them takes a fifth of its time.
    """
    before = gc.get_threshold()
    gc.set_threshold(*GC_THRESHOLDS)
    try:
        yield
    finally:
        gc.set_threshold(*before)
