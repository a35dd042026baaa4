"""The compiler behind the decorators of ``kernel.py``.

Numba compiles kernels for exactness first: no ``fastmath`` (replays must match bit for bit) and divisions as
in IEEE 754. Kernels release the GIL, because the server and batches run them in threads.

Compiled code is cached on disk for every process that runs the same sources, whatever their location
(see ``kernel_cache.py``). The traceback of an error in a kernel names the files that were compiled.
"""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numba
from numba.core.compiler_lock import global_compiler_lock

from wildscav_engine.compilation.caching.cache_folders import cache_folder, shipped_folder
from wildscav_engine.compilation.caching.locks import locked
from wildscav_engine.compilation.kernel_cache import KernelCache
from wildscav_engine.compilation.linking import (
    BitcodeCache,
    BitcodeCompiler,
    DisjointBitcodeCompiler,
    LinkedCompiler,
    for_all_numbers,
)
from wildscav_engine.compilation.notice import notice
from wildscav_engine.compilation.shortcuts import shortcuts

__all__ = ["compile_inner", "compile_outer", "global_compiler_lock", "typeof"]

# Annotated as Any, because Numba has options that its type stubs do not contain.
njit: Any = numba.njit
typeof: Any = numba.typeof

Function = Callable[..., Any]

GC_THRESHOLDS = (100_000, 50, 1000)  # as in ``gc.set_threshold``
EXACT_OPTIONS = {"fastmath": False, "nogil": True, "error_model": "numpy"}
# For every kernel that is not to be inlined: Numba would pass that option on from an inlined kernel to those
# that it calls, if they are not compiled yet, and so on downwards.
NOT_INLINED = {"forceinline": False}


def compile_outer(
    function: Function,
    home: Function,
    *,
    disjoint: bool = False,  # noqa: ARG001
    **options: Any,
) -> Any:
    """Return a function that compiles itself when it is first called from Python.

    Its code is kept with that of the file of ``home``. ``disjoint`` does not matter: it helps where other
    kernels inline the function.
    """
    options = {"no_cfunc_wrapper": True, **options}
    name, file = "-".join(sorted(options)), _file_of(home)
    shipped = shipped_folder(file)
    cache = KernelCache(function, cache_folder(file) / name, shipped and shipped / name)
    return _with_cache(njit(pipeline_class=LinkedCompiler, **EXACT_OPTIONS, **options)(function), cache)


def compile_inner(function: Function, home: Function, *, disjoint: bool = False, **options: bool) -> Any:
    """Return a function that compiles itself when it is first called from a kernel; see ``compile_outer``."""
    name = "-".join(["part", *sorted(options), *["disjoint"] * disjoint])
    part = njit(
        pipeline_class=DisjointBitcodeCompiler if disjoint else BitcodeCompiler,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        **EXACT_OPTIONS,
        **(NOT_INLINED | options),
    )(function)
    return _with_cache(for_all_numbers(part), BitcodeCache(function, cache_folder(_file_of(home)) / name))


def _file_of(function: Function) -> Path:
    """Return the file of a function.

    Its cache has a folder for each set of options, because Numba does not distinguish code by its options.
    """
    return Path(function.__code__.co_filename)


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
        if signature in dispatcher.overloads:
            return dispatcher.overloads[signature].entry_point
        with (
            global_compiler_lock,
            notice.waiting(),
            locked(lock, lambda: notice.begin(0)),
            _rare_garbage_collection(),
            shortcuts(),
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
