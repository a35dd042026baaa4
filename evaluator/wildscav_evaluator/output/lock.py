"""The lock of an output folder, held by one evaluation at a time until its last worker has ended.

The lock is on an open file that the workers inherit. When an evaluation is killed, its workers take a moment
to end. Until then they hold the lock, and the next evaluation waits for them.
"""

import contextlib
import fcntl
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import reduction
from pathlib import Path
from typing import Any

from wildscav.errors import UserError

LOCK = ".evaluating"
TIMEOUT = 30.0  # s to wait for the workers of an evaluation that was killed
POLL_INTERVAL = 0.05  # s between two attempts to take the lock


class Lock:
    """An open file with a lock on it; a process that is spawned with it also holds the lock."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor

    def __reduce__(self) -> tuple[Any, ...]:
        return _inherit, (reduction.DupFd(self.descriptor),)


def _inherit(duplicate: Any) -> Lock:
    return Lock(duplicate.detach())


@contextmanager
def locked(folder: Path) -> Iterator[Lock]:
    """Hold the lock of a folder, and remove its file at the end; UserError if another evaluation holds it."""
    path = folder / LOCK
    descriptor = _take(path, folder)
    try:
        _write_holder(descriptor, path)
        yield Lock(descriptor)
    finally:
        # Removed while it is still locked, so that a later process cannot lock the same file.
        path.unlink(missing_ok=True)
        os.close(descriptor)


def _write_holder(descriptor: int, path: Path) -> None:
    """Write which process holds the lock; UserError if the disk is full, say."""
    try:
        os.truncate(descriptor, 0)
        os.write(descriptor, str(os.getpid()).encode())
    except OSError as error:
        raise UserError(f"{path} cannot be written: {error.strerror}") from error


def _take(path: Path, folder: Path) -> int:
    """Return an open file with the lock, after waiting for workers that still hold it."""
    deadline = time.monotonic() + TIMEOUT
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # The previous holder may have removed the file after we opened it and before we locked it.
            if os.path.samestat(path.stat(), os.fstat(descriptor)):
                return descriptor
        except FileNotFoundError:
            pass
        except OSError as error:
            if _holder_lives(path) or time.monotonic() > deadline:
                os.close(descriptor)
                raise UserError(
                    f"another evaluation is writing to {folder}: wait for it, or name another --out"
                ) from error
        os.close(descriptor)
        time.sleep(POLL_INTERVAL)


def _holder_lives(path: Path) -> bool:
    """Return whether the evaluation that took the lock is alive, and not only workers that it left."""
    try:
        holder = int(path.read_text())
        os.kill(holder, 0)
    except PermissionError:
        return True  # another user's process
    except (OSError, ValueError):
        return False
    return not _is_zombie(holder)


def _is_zombie(process: int) -> bool:
    with contextlib.suppress(OSError, IndexError):
        # "pid (name) state …"; the name may hold spaces and brackets.
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] in "ZX"
    return False
