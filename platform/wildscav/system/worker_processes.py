"""Worker processes: they ignore Ctrl-C, and they never outlive the process that started them."""

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import parent_process, resource_tracker

PR_SET_PDEATHSIG = 1
GRACE = 20.0  # s that an orphaned worker has to end by itself


@contextmanager
def starting_workers() -> Iterator[None]:
    """Block Ctrl-C, which a terminal sends to all processes, in processes that are started in this block.

    It stays blocked in each of them until ``become_worker``: a Ctrl-C during imports would print a traceback.
    """
    resource_tracker.ensure_running()  # otherwise starting the first worker starts it and unblocks Ctrl-C
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def become_worker(parent: int) -> None:
    """Ignore Ctrl-C, and end when the parent process ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    end_with_parent(parent)


def end_with_parent(parent: int) -> None:
    """Make this process end when its parent, by its id, has ended, for whatever reason.

    It gets a SIGTERM, and is killed if it does not end. (A worker that waits for work does not notice that
    its parent was killed, because its siblings hold the pipe open.)
    """
    if sys.platform == "linux":  # where the kernel sends the signal at once
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it ended before the line above
        raise SystemExit(128 + signal.SIGTERM)
    threading.Thread(target=_end_orphan, daemon=True).start()


def _end_orphan() -> None:
    parent = parent_process()
    if parent is None:
        return
    parent.join()
    if sys.platform != "linux":
        os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE)
    os.kill(os.getpid(), signal.SIGKILL)
