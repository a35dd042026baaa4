"""The one decorator of every compiled function.

Kernels are compiled by Numba for exactness first: no ``fastmath`` (replays must match bit for bit), no
GIL (the server and batches run them in threads), and cached on disk.

Numba's cache notices edits only in a kernel's own file: after an edit of a helper or of a constant that
stands elsewhere, it would silently keep the old code. So the cache folder is named after a digest of every
source file of the engine; an edit anywhere starts a new folder.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
import numpy as np

Params = ParamSpec("Params")
Returned = TypeVar("Returned")

# The newest few folders are kept, so that going back and forth between versions stays fast.
KEPT_FOLDERS = 8


def source_digest() -> str:
    """Return a digest of the engine's sources and of the versions that compile them."""
    package = Path(__file__).parent
    digest = hashlib.blake2b(f"numba {numba.__version__} numpy {np.__version__}".encode(), digest_size=8)
    for path in sorted(package.rglob("*.py")):
        digest.update(str(path.relative_to(package)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def cache_folder() -> Path:
    """Return the folder for compiled code, made if need be; a temporary one if none can be written."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
    root = Path(os.environ.get("WILDSCAV_CACHE_DIR") or Path(home) / "wildscav") / "kernels"
    folder = root / source_digest()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        folder.touch()
        _remove_old_folders(root)
    except OSError:
        return Path(tempfile.mkdtemp(prefix="wildscav-kernels-"))
    return folder


def _remove_old_folders(root: Path) -> None:
    import shutil

    folders = sorted(root.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for folder in folders[KEPT_FOLDERS:]:
        shutil.rmtree(folder, ignore_errors=True)


CACHE_FOLDER = cache_folder()


def kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function with the flags that every kernel of the engine shares."""
    return _compile(function, parallel=False)


def parallel_kernel(function: Callable[Params, Returned]) -> Callable[Params, Returned]:
    """Compile a function whose ``prange`` loops run over threads. Only vector environments use these."""
    return _compile(function, parallel=True)


def _compile(function: Callable[Params, Returned], *, parallel: bool) -> Callable[Params, Returned]:
    # Numba chooses a function's cache folder while decorating it, from its global configuration.
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(CACHE_FOLDER)
    try:
        compiled: Any = numba.njit(cache=True, fastmath=False, nogil=True, parallel=parallel)(function)
    finally:
        numba.config.CACHE_DIR = before
    return cast(Callable[Params, Returned], compiled)
