"""The folders of the cache of compiled code: one for each digest of sources."""

import atexit
import functools
import os
import shutil
import tempfile
from pathlib import Path

from wildscav_engine.compilation.sources import sources_digest

# Enough for several versions of the engine, so that switching between them stays fast.
KEPT_FOLDERS = 1000


def cache_root() -> Path:
    """Return the folder of all compiled code: in WILDSCAV_CACHE_DIR, or in the user's cache folder.

    For a user without a home directory, such as one of a container, it is in a temporary folder.
    """
    if named := os.environ.get("WILDSCAV_CACHE_DIR"):
        return Path(named) / "kernels"
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "wildscav" / "kernels"
    except RuntimeError:
        return _temporary_folder() / "kernels"


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
        return _temporary_folder()
    return folder


@functools.cache
def _temporary_folder() -> Path:
    """Create a folder that is removed when this process ends."""
    folder = Path(tempfile.mkdtemp(prefix="wildscav-kernels-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _remove_oldest_folders(root: Path) -> None:
    folders = sorted(filter(Path.is_dir, root.iterdir()), key=lambda path: path.stat().st_mtime, reverse=True)
    for folder in folders[KEPT_FOLDERS:]:
        shutil.rmtree(folder, ignore_errors=True)
