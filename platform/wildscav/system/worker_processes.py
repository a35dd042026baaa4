"""Worker processes: Ctrl-C is not for them, and they never outlive who started them."""

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
GRACE = 20.0  # s that an orphan has to end in good order


@contextmanager
def starting_workers() -> Iterator[None]:
    """Keep Ctrl-C, which a terminal sends to all, from processes that are started in this block.

    Each keeps it off until it calls ``become_worker``: a Ctrl-C during its imports would print a traceback.
    """
    resource_tracker.ensure_running()  # which the first worker would start, and let Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def become_worker(parent: int) -> None:
    """Leave Ctrl-C to the process that started this one, and end with it.

    Args:
        parent: That process.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    end_with_parent(parent)


def end_with_parent(parent: int) -> None:
    """Have this process end when its parent is gone, however that came about.

    It gets a SIGTERM, and is killed if that did not end it. (A worker that waits for work hears nothing of a
    killed parent by itself, since its siblings hold the pipe open.)

    Args:
        parent: The process that started this one.
    """
    if sys.platform == "linux":  # which tells at once, and needs no thread of ours for it
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it was gone before anybody watched
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
