"""Folders that take long to fill, filled once for all processes of the tests."""

import fcntl
from collections.abc import Callable
from pathlib import Path


def made_once(folder: Path, fill: Callable[[Path], object]) -> Path:
    """Return a folder that all processes of the tests have, which the first one that asks fills."""
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        whole = folder.with_suffix(".whole")
        if not whole.exists():
            fill(folder)
            whole.touch()
    return folder
