"""Reporting errors to the client's user: the original's protocol has no messages for that.

The client writes its engine's output to a file or discards it. So warnings and errors are also written to
the client's own stderr, and a client that would wait forever is interrupted as by Ctrl-C. Both are done only
if it is certain which process the client is: the parent of this process, if it listens on the port that was
given to this one. That can be found out on Linux only; elsewhere there is just the log.
"""

import logging
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

LISTENING = "0A"  # the state in Linux's tables of sockets
TABLES = ("tcp", "tcp6")


class ClientStderrHandler(logging.Handler):
    """Writes warnings and errors to the stderr of another process, each text once."""

    def __init__(self, process: int) -> None:
        """Write to the stderr of a process.

        Args:
            process: The process's id.
        """
        super().__init__(logging.WARNING)
        self._path = Path(f"/proc/{process}/fd/2")
        self._written: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record. Errors in writing are ignored, because the client may have closed its stderr."""
        text = record.getMessage()
        if text in self._written:
            return
        self._written.add(text)
        with suppress(OSError), self._path.open("a", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"wildscav: {record.levelname.lower()}: {text}\n")


def find_client(port: int) -> int | None:
    """Return the id of the parent process if it listens on a port, else None."""
    parent = os.getppid()
    with suppress(OSError):
        files = {str(each.readlink()) for each in Path(f"/proc/{parent}/fd").iterdir()}
        if files & {f"socket:[{inode}]" for inode in _listeners(port)}:
            return parent
    return None


def has_own_stderr(process: int) -> bool:
    """Return whether a process has a different stderr from this one."""
    with suppress(OSError):
        other = Path(f"/proc/{process}/fd/2").stat()
        return not os.path.samestat(other, os.fstat(sys.stderr.fileno()))
    return False


def interrupt(process: int) -> None:
    """Interrupt a process, as Ctrl-C does."""
    with suppress(OSError):
        os.kill(process, signal.SIGINT)


def _listeners(port: int) -> set[str]:
    """Return the inodes of the sockets that listen on a port."""
    found = set()
    for table in TABLES:
        with suppress(OSError):
            for line in Path(f"/proc/self/net/{table}").read_text().splitlines()[1:]:
                fields = line.split()
                if fields[3] == LISTENING and int(fields[1].rpartition(":")[2], 16) == port:
                    found.add(fields[9])
    return found
