"""The cache of compiled code on disk: a folder for each digest of sources, shared by all checkouts.

Numba's own cache is keyed by the paths of source files and notices only edits of a kernel's own file. After
an edit of a helper or a constant in another file, it would silently use the old code. This module therefore
gives Numba a folder whose name depends on everything that can change the code.

The machine code of a wheel lies in folders like these, which are only read.
"""

import functools
import pickle
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core import caching
from numba.core.runtime import nrt

from wildscav_engine.compilation.caching.levels import levels, processor_of
from wildscav_engine.compilation.notice import notice

# Annotated as Any, because Numba has no types for them.
NumbaCache: Any = caching.FunctionCache
NumbaEntries: Any = caching.CompileResultCacheImpl
NumbaLocator: Any = caching._CacheLocator
CacheFile: Any = caching.IndexDataCacheFile
rtsys: Any = nrt.rtsys

DAMAGED = (OSError, EOFError, pickle.UnpicklingError)


class Locator(NumbaLocator):  # type: ignore[misc]
    """Gives Numba the folder of a function's compiled code."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._py_file = function.__code__.co_filename  # named in Numba's warnings
        self._line = function.__code__.co_firstlineno
        self._folder = folder

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return an empty stamp: the name of the folder distinguishes old code from new."""
        return ""

    def get_disambiguator(self) -> str:
        """Return the line of the function, which distinguishes functions of the same name."""
        return str(self._line)


class Entries(NumbaEntries):  # type: ignore[misc]
    """The cache entries of a compiled function."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        code = function.__code__
        self._lineno = code.co_firstlineno
        self._locator = Locator(function, folder)
        self._filename_base = self.get_filename_base(
            f"{Path(code.co_filename).stem}.{function.__qualname__}", ""
        )

    def reduce(self, result: Any) -> Any:
        """Return what Numba caches, without the list of variables, which contains file names."""
        return super().reduce(result._replace(type_annotation=""))


class KernelCache(NumbaCache):  # type: ignore[misc]
    """The cache of one function: damaged entries are compiled again, and failed writes are ignored."""

    entries: type[Entries] = Entries

    def __init__(self, function: Callable[..., Any], folder: Path, shipped: Path | None = None) -> None:
        """Use a folder of cached code, and one of a wheel's machine code."""
        self._impl_class = functools.partial(self.entries, folder=folder)
        super().__init__(function)
        self._shipped: Any = shipped and CacheFile(str(shipped), self._impl.filename_base, "")

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the compiled code for a signature, or None if it has to be compiled, which then begins."""
        found = self._load(signature, context)
        if found is None:
            notice.begin()
        return found

    def _load(self, signature: Any, context: Any) -> Any:
        rtsys.initialize(context)  # all that cached code needs of Numba, whose definitions take long to load
        with suppress(*DAMAGED):
            if found := self._load_shipped(signature, context):
                return found
        try:
            return self._load_overload(signature, context)
        except DAMAGED:
            with suppress(OSError):
                self.flush()
            return None

    def _load_shipped(self, signature: Any, context: Any) -> Any:
        """Return the machine code that a wheel brings for a signature, or None."""
        if self._shipped is None:
            return None
        _, (system, *_), function = self._index_key(signature, context.codegen())
        keys = ((signature, (system, *processor_of(level)), function) for level in levels())
        cached = next(filter(None, map(self._shipped.load, keys)), None)
        return cached and self._impl.rebuild(context, cached)

    def save_overload(self, signature: Any, result: Any) -> None:
        """Cache the compiled code for a signature."""
        with suppress(OSError):
            super().save_overload(signature, result)
