"""Reading the kernel's log for processes that were killed because memory ran out.

A container's control group disappears with the container, and its counters with it. The log remains, but only
root may read it.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from wildscav_evaluator.sandbox.base import MemoryKill

LOG = Path("/dev/kmsg")
LONGEST = 8192  # bytes of a record
# The format of mm/oom_kill.c since Linux 5.0: the control group that ran out of memory, unless the whole
# machine did, and the control group of the process that was killed for it.
KILL = re.compile(rb"oom-kill:.*,(?:oom_memcg=(?P<short>[^,]*)|global_oom),task_memcg=(?P<of>[^,]*)")


def logged_kill(container: str) -> MemoryKill | None:
    """Return whose memory ran out when processes of a container were killed; None if the log is unreadable.

    The container's identity is in the names of its control groups.
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
    """Yield the records of the log; OSError if it does not exist, or may not be read."""
    log = os.open(LOG, os.O_RDONLY | os.O_NONBLOCK)
    try:
        while True:
            try:
                yield os.read(log, LONGEST)
            except BlockingIOError:  # there are no more records
                return
            except BrokenPipeError:  # the oldest record was overwritten meanwhile
                continue
    finally:
        os.close(log)
