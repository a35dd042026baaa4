"""Where compiled code is kept: in a folder for each digest of sources, whoever compiled it.

Numba's own cache files functions under the paths of their sources, and notices only edits of a kernel's own
file: after one of a helper or of a constant elsewhere, it would silently keep the old code. So Numba is told
here where to look, and whatever could change the code is in the folder's name.
"""

import functools
import pickle
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core import caching

from wildscav_engine.compilation.notice import notice

# Typed here, because Numba comes without types.
NumbaCache: Any = caching.FunctionCache
NumbaEntries: Any = caching.CompileResultCacheImpl
NumbaLocator: Any = caching._CacheLocator

DAMAGED = (OSError, EOFError, pickle.UnpicklingError)


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
        """Return the compiled code for a signature; None if it has to be compiled, which begins then."""
        found = self._load(signature, context)
        if found is None:
            notice.begin()
        return found

    def _load(self, signature: Any, context: Any) -> Any:
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
