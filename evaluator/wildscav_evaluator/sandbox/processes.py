"""The processes of this machine, as Linux shows them in /proc."""

import contextlib
import errno
import os
import signal
from collections.abc import Callable


def all_processes() -> list[int]:
    """Return the numbers of all processes."""
    return [int(name) for name in os.listdir("/proc") if name.isdecimal()]  # noqa: PTH208 - it is quick


def read_file(process: int, name: str) -> bytes:
    """Return one of a process's files; nothing if the process has ended or is another user's."""
    # Half the time of Path.read_bytes, and there are hundreds of processes.
    with contextlib.suppress(OSError), open(f"/proc/{process}/{name}", "rb", buffering=0) as file:  # noqa: PTH123
        return file.read()
    return b""


def open_process(process: int) -> int | None:
    """Return a pidfd, which stands for a process whoever gets its number later; None before Linux 5.3.

    ProcessLookupError if the process has ended.
    """
    try:
        return os.pidfd_open(process)
    except OSError as error:
        if error.errno != errno.ENOSYS:
            raise
        return None


def kill(process: int, is_meant: Callable[[int], bool]) -> None:
    """Kill a process, and never another one that gets its number meanwhile: ``is_meant`` tells them apart."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        opened = open_process(process)
        try:
            if is_meant(process):
                if opened is None:
                    os.kill(process, signal.SIGKILL)
                else:
                    signal.pidfd_send_signal(opened, signal.SIGKILL)
        finally:
            if opened is not None:
                os.close(opened)
