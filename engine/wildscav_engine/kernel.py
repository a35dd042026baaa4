"""The one decorator of every compiled function.

Kernels are compiled by Numba for exactness first: no ``fastmath`` (replays must match bit for bit),
divisions as IEEE 754 has them, no GIL (the server and batches run kernels in threads), cached on disk.

Numba's cache notices edits only in a kernel's own file: after an edit of a helper or of a constant that
stands elsewhere, it would silently keep the old code. So a kernel's cache folder is named after a digest of
its file and of every file of the engine that this one imports, directly or not; an edit of any of them
starts a new folder.
"""

import ast
import functools
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import blake2b
from pathlib import Path
from typing import Any, NoReturn, ParamSpec, TypeVar, cast

import numba
import numpy as np
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import typeof_impl

from wildscav_engine.linking import PartCompiler, keep

try:
    import fcntl
except ImportError:  # a system without such locks: each process compiles for itself
    fcntl = None  # type: ignore[assignment]

Params = ParamSpec("Params")
Returned = TypeVar("Returned")

# Typed here, because Numba adds settings and options that its type stubs do not know.
config: Any = numba.config
njit: Any = numba.njit
typeof: Any = numba.typeof

EXACTLY = {"fastmath": False, "nogil": True, "error_model": "numpy"}
PACKAGE = Path(__file__).parent
# As many folders are kept as several versions of the engine need, so that going back and forth stays fast.
KEPT_FOLDERS = 1000


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
        return _take_nothing
    compiled = cast(Kernel, function).outer
    compiled.compile(tuple(typeof(example) for example in examples))
    compiled.disable_compile()
    return cast(Callable[..., Returned], compiled)


def _take_nothing(*_: Any) -> NoReturn:
    raise TypeError("kernels are plain Python: nobody knows which arguments they take")


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    with _caching_in(function, "-".join(sorted(options)) or "plain"):
        return _in_turn(njit(cache=True, **EXACTLY, **options)(function))


def _in_turn(dispatcher: Any) -> Any:
    """Let only one process at a time compile a function, or look for it on disk; return the function.

    Two that compile one at once would both compile all that it calls, and could mix up what they keep: Numba
    numbers the files of a function's types as it finds them. Nobody waits forever: who waits for a kernel has
    locked only what calls it.
    """
    compile_now, name = dispatcher.compile, f"{dispatcher.py_func.__qualname__}.lock"
    folder = Path(dispatcher._cache.cache_path)  # noqa: SLF001 - Numba has no other way to ask

    def compile_alone(signature: Any) -> Any:
        with global_compiler_lock, _lock(folder / name):
            return compile_now(signature)

    dispatcher.compile = compile_alone
    return dispatcher


@contextmanager
def _lock(file: Path) -> Iterator[None]:
    """Hold a lock between processes; where none can be had, do without."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        yield
        return
    try:
        if fcntl is not None:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _compile_part(function: Callable[..., Any], **options: bool) -> Any:
    """Compile a function for calls from kernels alone."""
    part = njit(
        pipeline_class=PartCompiler, no_cpython_wrapper=True, no_cfunc_wrapper=True, **EXACTLY, **options
    )(function)
    with _caching_in(function, "-".join(["part", *sorted(options)])):
        return _in_turn(keep(part))


@contextmanager
def _caching_in(function: Callable[..., Any], name: str) -> Iterator[None]:
    # Numba chooses a function's cache folder while decorating it, from its global configuration. It does not
    # tell apart what was compiled with other options: each set of options has a folder of its own.
    before = config.CACHE_DIR
    config.CACHE_DIR = str(cache_folder(Path(function.__code__.co_filename)) / name)
    try:
        yield
    finally:
        config.CACHE_DIR = before


def cache_root() -> Path:
    """Return the folder of all compiled code: WILDSCAV_CACHE_DIR, or the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
    return Path(os.environ.get("WILDSCAV_CACHE_DIR") or Path(home) / "wildscav") / "kernels"


@functools.cache
def cache_folder(file: Path) -> Path:
    """Return the cache folder for a file's kernels, made if need be; a temporary one where that fails."""
    folder = cache_root() / sources_digest(file)
    try:
        if not folder.exists():
            folder.mkdir(parents=True)
            _remove_oldest_folders(folder.parent)
        folder.touch()
    except OSError:
        return _temporary_folder()
    return folder


@functools.cache
def _temporary_folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="wildscav-kernels-"))


def _remove_oldest_folders(root: Path) -> None:
    folders = sorted(root.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for folder in folders[KEPT_FOLDERS:]:
        shutil.rmtree(folder, ignore_errors=True)


def sources_digest(file: Path) -> str:
    """Return a digest of a file, of all engine files it depends on, and of the compiler's version."""
    digest = blake2b(f"numba {numba.__version__} numpy {np.__version__}".encode(), digest_size=8)
    for path in sorted(_closure(file)):
        digest.update(str(path).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _closure(file: Path) -> set[Path]:
    """Return a file and every engine file that it imports, directly or not."""
    found: set[Path] = set()
    waiting = [file]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(_imported_files(path))
    return found


@functools.cache
def _imported_files(file: Path) -> tuple[Path, ...]:
    """Return the engine files that a file imports at its top level."""
    paths = []
    for node in ast.parse(file.read_bytes()).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(f"{PACKAGE.name}"):
            path = PACKAGE.joinpath(*(node.module or "").split(".")[1:])
            paths.append(path / "__init__.py" if path.is_dir() else path.with_suffix(".py"))
    return tuple(paths)
