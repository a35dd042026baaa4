"""The log of an agent's output: saved to a file up to a limit, with the last lines in memory."""

import asyncio
import json
import os
from itertools import accumulate
from pathlib import Path

TAIL = 32_768  # bytes kept in memory to explain a failure
LAST_LINES = 20  # of the tail
LAST_SIZE = 4_096  # bytes of these lines as JSON, so that results of many failures can be read
CHUNK = 65_536  # bytes
DISCARD_DELAY = 0.005  # s between chunks beyond the limit, so that a flood slows its writer and not us
LINE = 200  # characters of a line that are kept
CUT = "[the log is cut here]"


class CappedLog:
    """Appends a stream to a file up to a limit, bytes; then reads on slowly, to block no writer."""

    def __init__(self, path: Path, limit: int) -> None:
        self._path, self._left = path, limit
        self._tail = b""

    async def copy(self, stream: asyncio.StreamReader) -> None:
        """Copy until the stream ends. If the log cannot be written, the match still goes on."""
        while chunk := await stream.read(CHUNK):
            self._tail = (self._tail + chunk)[-TAIL:]
            if self._left > 0:
                kept = chunk[: self._left]
                self._left -= len(kept) if self._append(kept) else self._left
                if self._left == 0:
                    self._append(f"\n{CUT}\n".encode())
            else:
                await asyncio.sleep(DISCARD_DELAY)

    def lines(self) -> list[str]:
        """Return the last lines, as far as they are in memory."""
        return [_shortened(line) for line in self._tail.decode("utf-8", "replace").splitlines()]

    def last_lines(self) -> tuple[str, ...]:
        """Return the last lines, at most twenty of them, and of those as many as fit into the results."""
        backwards = self.lines()[: -LAST_LINES - 1 : -1]
        sizes = accumulate(len(json.dumps(line)) for line in backwards)
        kept = sum(size <= LAST_SIZE for size in sizes)
        return tuple(reversed(backwards[:kept]))

    def _append(self, content: bytes) -> bool:
        try:
            with self._path.open("ab") as file:
                file.write(content)
        except OSError:
            return False
        return True


def is_cut(path: Path) -> bool:
    """Return whether a finished log was cut and so lacks some of its agent's output."""
    ending = f"\n{CUT}\n".encode()
    try:
        with path.open("rb") as file:
            file.seek(-min(len(ending), path.stat().st_size), os.SEEK_END)
            return file.read() == ending
    except OSError:
        return False


def _shortened(line: str) -> str:
    """Return a line, or the whole words at its beginning if it is too long."""
    if len(line) <= LINE:
        return line
    words = line[:LINE].rpartition(" ")[0]
    return f"{words if words.strip() else line[:LINE]} …"
