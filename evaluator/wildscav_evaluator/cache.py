"""The cache: files that are kept between runs and can be recreated."""

import os
import shutil
import time
from contextlib import suppress
from pathlib import Path

from wildscav_engine.compilation.caching.cache_root import cache_root

LARGEST = 20 << 30  # bytes of one kind of file
OLDEST = 30 * 86_400.0  # s for which something is kept that nobody uses
IN_USE = 86_400.0  # s for which it may still be in use after somebody asked for it


def cache_folder(name: str) -> Path:
    """Return the folder for one kind of file, in WILDSCAV_CACHE_DIR or in the user's cache folder."""
    return cache_root().parent / name


def is_kept(entry: Path) -> bool:
    """Return whether there is an entry in a cache, and note that it is used."""
    with suppress(FileNotFoundError):
        os.utime(entry)
        return True
    return False


def prune(folder: Path, largest: int = LARGEST) -> None:
    """Remove what nobody used for long and, beyond ``largest`` bytes, what was not used for the longest time.

    Whatever was used within a day stays, since it may be in use.
    """
    total, now = 0, time.time()
    for entry in sorted(folder.iterdir(), key=_used, reverse=True):
        total += sum(path.lstat().st_size for path in (entry, *entry.rglob("*")))
        if now - _used(entry) > (OLDEST if total <= largest else IN_USE):
            shutil.rmtree(entry, ignore_errors=True)


def _used(entry: Path) -> float:
    try:
        return entry.stat().st_mtime
    except FileNotFoundError:  # another process removed it
        return 0.0
