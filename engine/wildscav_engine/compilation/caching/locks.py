"""Locks between processes: operating-system file locks, which are released when their process ends."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # a system without such locks: every process proceeds without waiting
    fcntl = None  # type: ignore[assignment]


class Lock:
    """An exclusive lock on a file; where files cannot be locked, every process gets it."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._descriptor: int | None = None

    def take(self, *, waiting: bool = False) -> bool:
        """Acquire the lock and return True; without ``waiting``, return False if another process holds it."""
        try:
            if self._descriptor is None:
                self._file.parent.mkdir(parents=True, exist_ok=True)
                self._descriptor = os.open(self._file, os.O_RDWR | os.O_CREAT, 0o666)
            if fcntl is not None:
                fcntl.flock(self._descriptor, fcntl.LOCK_EX | (0 if waiting else fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        except OSError:
            return True
        return True

    def release(self, *, removing: bool = False) -> None:
        """Release the lock; with ``removing``, remove the file first."""
        if removing:
            with suppress(OSError):
                self._file.unlink()
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


@contextmanager
def locked(file: Path, before_waiting: Callable[[], None] | None = None) -> Iterator[None]:
    """Hold a lock on a file; if another process holds it, call ``before_waiting`` and wait."""
    lock = Lock(file)
    if not lock.take():
        if before_waiting is not None:
            before_waiting()
        lock.take(waiting=True)
    try:
        yield
    finally:
        lock.release()
