"""What the kernel's log says about processes that were killed for want of memory.

A container's control group is gone with the container, and with it what was counted there. The log stays, if
one may read it: root may.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from wildscav_evaluator.sandbox.base import MemoryKill

LOG = Path("/dev/kmsg")
LONGEST = 8192  # bytes of a record
# As mm/oom_kill.c writes it from Linux 5.0 on: the control group that was short of memory, unless all of the
# machine was, and that of the process which was killed for it.
KILL = re.compile(rb"oom-kill:.*,(?:oom_memcg=(?P<short>[^,]*)|global_oom),task_memcg=(?P<of>[^,]*)")


def logged_kill(container: str) -> MemoryKill | None:
    """Return for want of whose memory the kernel killed processes of a container; None if it may not be read.

    Args:
        container: Its identity, which is in the names of its control groups.
    """
    try:
        kills = {MemoryKill.NONE, *(read_kill(record, container) for record in _records())}
    except OSError:
        return None
    return next(kill for kill in (MemoryKill.OWN, MemoryKill.MACHINES, MemoryKill.NONE) if kill in kills)


def read_kill(record: bytes, container: str) -> MemoryKill:
    """Return what a record of the log says about a container."""
    kill, name = KILL.search(record), container.encode()
    if kill is None or name not in kill["of"]:
        return MemoryKill.NONE
    return MemoryKill.OWN if name in (kill["short"] or b"") else MemoryKill.MACHINES


def _records() -> Iterator[bytes]:
    """Yield what is in the log.

    Raises:
        OSError: It is not there, or may not be read.
    """
    log = os.open(LOG, os.O_RDONLY | os.O_NONBLOCK)
    try:
        while True:
            try:
                yield os.read(log, LONGEST)
            except BlockingIOError:  # all is read
                return
            except BrokenPipeError:  # the oldest was overwritten meanwhile
                continue
    finally:
        os.close(log)
