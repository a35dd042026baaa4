"""Reaching the person who runs the client: the contract has no words for faults, and the client waits.

The client keeps what its engine prints in a file, or nowhere. So warnings and errors are written to the
client's own stderr, too, and a client that would wait forever is interrupted as by Ctrl-C. Both only where
it is certain who the client is: the process that started this one, if it listens on the port that this one
was told. That can be known on Linux only; elsewhere there is the log.
"""

import logging
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

LISTENING = "0A"  # in Linux' tables of sockets
TABLES = ("tcp", "tcp6")


class UserHandler(logging.Handler):
    """Writes warnings and errors to the stderr of another process, each text once."""

    def __init__(self, process: int) -> None:
        """Write to a process.

        Args:
            process: Its id.
        """
        super().__init__(logging.WARNING)
        self._path = Path(f"/proc/{process}/fd/2")
        self._said: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, if it can be written: nobody is to fail for want of a terminal."""
        text = record.getMessage()
        if text in self._said:
            return
        self._said.add(text)
        with suppress(OSError), self._path.open("a", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"wildscav: {record.levelname.lower()}: {text}\n")


def find_client(port: int) -> int | None:
    """Return the id of the process that started this one if it listens on a port, else None."""
    parent = os.getppid()
    with suppress(OSError):
        files = {str(each.readlink()) for each in Path(f"/proc/{parent}/fd").iterdir()}
        if files & {f"socket:[{inode}]" for inode in _listeners(port)}:
            return parent
    return None


def has_own_stderr(process: int) -> bool:
    """Return whether a process has another stderr than this one."""
    with suppress(OSError):
        its = Path(f"/proc/{process}/fd/2").stat()
        return not os.path.samestat(its, os.fstat(sys.stderr.fileno()))
    return False


def interrupt(process: int) -> None:
    """End what a process waits for, as Ctrl-C does."""
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
