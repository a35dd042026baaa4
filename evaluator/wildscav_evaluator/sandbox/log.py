"""What an agent prints: kept in a file up to a limit, its last lines in memory."""

import asyncio
from pathlib import Path

TAIL = 4096  # bytes remembered for the reason of a failure
LAST_LINES = 20  # of the tail
CHUNK = 65_536  # bytes
BEYOND = 0.005  # s between chunks beyond the limit, so that a flood costs its writer and not us
LINE = 200  # characters of a line
TRACEBACK = "Traceback (most recent call last):"


class CappedLog:
    """Copies a stream into a file until the limit, and reads on, unhurriedly, so that the writer gets on.

    Args:
        path: Of the file; what is in it stays.
        limit: Bytes kept.
    """

    def __init__(self, path: Path, limit: int) -> None:
        self._path, self._left = path, limit
        self._tail = b""

    async def copy(self, stream: asyncio.StreamReader) -> None:
        """Copy until the stream ends. A log that cannot be written costs the log, never the match."""
        while chunk := await stream.read(CHUNK):
            self._tail = (self._tail + chunk)[-TAIL:]
            if self._left > 0:
                self._keep(chunk[: self._left])
            else:
                await asyncio.sleep(BEYOND)

    def _keep(self, chunk: bytes) -> None:
        self._left -= len(chunk) if self._append(chunk) else self._left
        if self._left == 0:
            self._append(b"\n[the log is cut here]\n")

    def last_words(self) -> str:
        """Return the first line of the exception that the log ends with, else its last line, or nothing."""
        lines = self._lines()
        starts = [number for number, line in enumerate(lines) if line.startswith(TRACEBACK)]
        if starts:
            # The frames are indented; a message may have many lines after its first.
            for line in lines[starts[-1] + 1 :]:
                if line.strip() and not line[0].isspace():
                    return line.strip()
        return next((line.strip() for line in reversed(lines) if line.strip()), "")

    def last_lines(self) -> tuple[str, ...]:
        """Return the last lines, at most twenty of them."""
        return tuple(self._lines()[-LAST_LINES:])

    def _lines(self) -> list[str]:
        return [line[:LINE] for line in self._tail.decode("utf-8", "replace").splitlines()]

    def _append(self, content: bytes) -> bool:
        try:
            with self._path.open("ab") as file:
                file.write(content)
        except OSError:
            return False
        return True
