"""The folders of the cache of compiled code: one for each digest of sources.

A wheel brings machine code for some levels of processors (see ``levels.py``) in a folder of the package. It
is only read; what is not in it is compiled, and cached as in a checkout.
"""

import functools
import shutil
from pathlib import Path

from wildscav_engine.compilation.caching.cache_root import cache_root, temporary_folder
from wildscav_engine.compilation.caching.levels import levels
from wildscav_engine.compilation.caching.sources import PACKAGE, sources_digest

# Enough for several versions of the engine, so that switching between them stays fast.
KEPT_FOLDERS = 1000

# The machine code of a wheel; in a checkout, there is none.
SHIPPED = PACKAGE / "compiled"


@functools.cache
def cache_folder(file: Path) -> Path:
    """Return the cache folder for a file's kernels, created on first use; a temporary one if that fails."""
    folder = cache_root() / sources_digest(file)
    try:
        if not folder.exists():
            folder.mkdir(parents=True, exist_ok=True)
            _remove_oldest_folders(folder.parent)
        folder.touch()
    except OSError:
        return temporary_folder()
    return folder


def shipped_folder(file: Path) -> Path | None:
    """Return the folder of a wheel's machine code for a file's kernels, or None if there is none."""
    folder = SHIPPED / sources_digest(file)
    return folder if levels() and folder.exists() else None


def _remove_oldest_folders(root: Path) -> None:
    folders = sorted(filter(Path.is_dir, root.iterdir()), key=lambda path: path.stat().st_mtime, reverse=True)
    for folder in folders[KEPT_FOLDERS:]:
        shutil.rmtree(folder, ignore_errors=True)
