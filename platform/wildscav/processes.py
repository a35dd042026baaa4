"""Worker processes that never outlive who started them."""

import ctypes
import os
import signal
import sys
import threading
import time
from multiprocessing import parent_process

PR_SET_PDEATHSIG = 1
GRACE = 20.0  # s that an orphan has to end in good order


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
