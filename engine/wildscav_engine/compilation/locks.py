"""Locks between processes: each is the operating system's lock on a file, and ends with its process."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # a system without such locks: each process acts as if it were alone
    fcntl = None  # type: ignore[assignment]


class Lock:
    """A lock on a file; where none can be had, everyone has it."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._descriptor: int | None = None

    def take(self, *, waiting: bool = False) -> bool:
        """Take the lock, and return whether it was free, or was waited for."""
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
        """Let others have it; remove the file first if it is of no more use."""
        if removing:
            with suppress(OSError):
                self._file.unlink()
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None


@contextmanager
def locked(file: Path, before_waiting: Callable[[], None] | None = None) -> Iterator[None]:
    """Hold a lock, after waiting for it if another process does.

    Args:
        file: To be locked.
        before_waiting: Is called if there is anything to wait for.
    """
    lock = Lock(file)
    if not lock.take():
        if before_waiting is not None:
            before_waiting()
        lock.take(waiting=True)
    try:
        yield
    finally:
        lock.release()
