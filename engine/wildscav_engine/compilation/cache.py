"""Where compiled code is kept: in a folder for each digest of sources, whoever compiled it.

Numba's own cache files functions under the paths of their sources, and notices only edits of a kernel's own
file: after one of a helper or of a constant elsewhere, it would silently keep the old code. So Numba is told
here where to look, and whatever could change the code is in the folder's name.
"""

import functools
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from numba.core import caching

from wildscav_engine.compilation.sources import sources_digest

try:
    import fcntl
except ImportError:  # a system without such locks: each process compiles for itself
    fcntl = None  # type: ignore[assignment]

# Typed here, because Numba comes without types.
NumbaCache: Any = caching.FunctionCache
NumbaEntries: Any = caching.CompileResultCacheImpl
NumbaLocator: Any = caching._CacheLocator

# As many folders are kept as several versions of the engine need, so that going back and forth stays fast.
KEPT_FOLDERS = 1000
DAMAGED = (OSError, EOFError, pickle.UnpicklingError)


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
            folder.mkdir(parents=True, exist_ok=True)
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


class Locator(NumbaLocator):  # type: ignore[misc]
    """Tells Numba where a function's code is kept."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._py_file = function.__code__.co_filename  # Numba's warnings name it
        self._line = function.__code__.co_firstlineno
        self._folder = folder

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return what tells old code from new: nothing, because the folder's name does."""
        return ""

    def get_disambiguator(self) -> str:
        """Return what tells functions of one name apart."""
        return str(self._line)


class Entries(NumbaEntries):  # type: ignore[misc]
    """What is kept of a compiled function."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        code = function.__code__
        self._lineno = code.co_firstlineno
        self._locator = Locator(function, folder)
        self._filename_base = self.get_filename_base(
            f"{Path(code.co_filename).stem}.{function.__qualname__}", ""
        )

    def reduce(self, result: Any) -> Any:
        """Return what is kept: all that Numba keeps, without the list of variables, which names files."""
        return super().reduce(result._replace(type_annotation=""))


class KernelCache(NumbaCache):  # type: ignore[misc]
    """The cache of one function: what is damaged is compiled again; what cannot be written is not kept."""

    entries: type[Entries] = Entries

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._impl_class = functools.partial(self.entries, folder=folder)
        super().__init__(function)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the compiled code for a signature, or None."""
        try:
            return super().load_overload(signature, context)
        except DAMAGED:
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the compiled code for a signature."""
        with suppress(OSError):
            super().save_overload(signature, result)


@contextmanager
def locked(file: Path) -> Iterator[None]:
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
