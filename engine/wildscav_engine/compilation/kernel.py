"""The one decorator of every compiled function.

Kernels are compiled by Numba for exactness first: no ``fastmath`` (replays must match bit for bit),
divisions as IEEE 754 has them, no GIL (the server and batches run kernels in threads), cached on disk.

What is compiled is kept on disk for every process that runs the same sources, wherever they lie
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

# Typed here, because Numba adds settings and options that its type stubs do not know.
config: Any = numba.config
njit: Any = numba.njit
typeof: Any = numba.typeof

SELDOM = (100_000, 50, 1000)  # as in ``gc.set_threshold``
EXACTLY = {"fastmath": False, "nogil": True, "error_model": "numpy"}


class Kernel:
    """A compiled function, compiled apart for calls from kernels and for calls from Python.

    Most kernels are only ever called by others. Machine code of them alone, and what converts their arguments
    from Python, would take longer to compile than they do, so both are left out until Python calls.
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
    """Compile a function that neither makes nor returns arrays: it reads and writes those it is given.

    So no references need counting, which would cost more than most kernels do (a world and the agents of a
    match are some forty arrays). To make an array in one is a compile-time error.
    """
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function, _nrt=False))


def inlined_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function like ``kernel`` that is copied into each kernel that calls it.

    A call hands over every number and every array's shape, strides and address one by one, so for small
    functions that get large tuples it costs more than the work.
    """
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function, _nrt=False, forceinline=True))


def array_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function that makes or returns arrays, views included."""
    if config.DISABLE_JIT:
        return function
    return cast(Callable[Params, Returned], Kernel(function))


def only_for(function: Callable[..., Returned], *examples: Any) -> Callable[..., Returned]:
    """Return a kernel for the shortest calls from Python: for one sort of arguments, and nothing between.

    It saves half a microsecond, and the caller the looking at what it was given: all other arguments raise
    TypeError or NumbaError, and are never compiled for.

    Args:
        function: A kernel.
        examples: An argument of each type that it is to take.
    """
    if config.DISABLE_JIT:
        return _only_for(function, [_sort(example) for example in examples])
    compiled = cast(Kernel, function).outer
    compiled.compile(tuple(typeof(example) for example in examples))
    compiled.disable_compile()
    return cast(Callable[..., Returned], compiled)


def _only_for(function: Callable[..., Returned], sorts: list[Any]) -> Callable[..., Returned]:
    """Do what ``only_for`` says, where kernels are plain Python."""

    def call(*arguments: Any) -> Returned:
        if [_sort(argument) for argument in arguments] != sorts:
            raise TypeError(f"{function.__name__} takes {sorts}")
        return function(*arguments)

    return call


def _sort(value: Any) -> Any:
    return (value.dtype, value.ndim) if isinstance(value, np.ndarray) else type(value)


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    folder = _folder_of(function, "-".join(sorted(options)) or "plain")
    # Without counted references it takes no second pass to find those that need none.
    whole = {} if options.get("_nrt", True) else {"pipeline_class": WholeCompiler}
    return _kept(njit(**EXACTLY, **options, **whole)(function), KernelCache(function, folder))


def _compile_part(function: Callable[..., Any], **options: bool) -> Any:
    """Compile a function for calls from kernels alone."""
    folder = _folder_of(function, "-".join(["part", *sorted(options)]))
    part = njit(
        pipeline_class=PartCompiler, no_cpython_wrapper=True, no_cfunc_wrapper=True, **EXACTLY, **options
    )(function)
    return _kept(for_all_numbers(part), PartCache(function, folder))


def _folder_of(function: Callable[..., Any], options: str) -> Path:
    # Numba does not tell apart what was compiled with different options, so each set has a folder of its own.
    return cache_folder(Path(function.__code__.co_filename)) / options


def _kept(dispatcher: Any, cache: KernelCache) -> Any:
    """Keep on disk what is compiled of a function, by one process at a time; return the function.

    Two that compile one at once would both compile all that it calls, and could mix up what they keep: Numba
    numbers the files of a function's types as it finds them. Nobody waits forever: who waits for a kernel has
    locked only what calls it.
    """
    compile_now = dispatcher.compile
    lock = Path(cache.cache_path) / f"{dispatcher.py_func.__qualname__}.lock"

    def compile_alone(signature: Any) -> Any:
        with (
            global_compiler_lock,
            notice.waiting(),
            locked(lock, lambda: notice.begin(0)),
            _seldom_collecting(),
        ):
            return compile_now(signature)

    dispatcher._cache = cache
    dispatcher.compile = compile_alone
    return dispatcher


@contextmanager
def _seldom_collecting() -> Iterator[None]:
    """Let Python look for garbage less often.

    A compiler makes a great many objects that stay: to look through them all takes a fifth of its time.
    """
    before = gc.get_threshold()
    gc.set_threshold(*SELDOM)
    try:
        yield
    finally:
        gc.set_threshold(*before)
