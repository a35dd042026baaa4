"""What an agent prints: kept in a file up to a limit, its last lines in memory."""

import asyncio
from pathlib import Path

LOG_LIMIT = 1_000_000  # bytes kept of one agent in one match
TAIL = 4096  # bytes remembered for the reason of a failure
CHUNK = 65_536  # bytes
TRACEBACK = "Traceback (most recent call last):"


class CappedLog:
    """Copies a stream into a file until the limit, and reads on so that the writer never blocks."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._tail = b""

    async def copy(self, stream: asyncio.StreamReader) -> None:
        """Copy until the stream ends. A log that cannot be written costs the log, never the match."""
        left = LOG_LIMIT
        while chunk := await stream.read(CHUNK):
            self._tail = (self._tail + chunk)[-TAIL:]
            kept = chunk[:left]
            if left > 0:
                left -= len(kept) if self._append(kept) else left
                if left == 0:
                    self._append(b"\n[the log is cut here]\n")

    def last_words(self) -> str:
        """Return the first line of the exception that the log ends with, else its last line, or nothing."""
        lines = self._tail.decode("utf-8", "replace").splitlines()
        starts = [number for number, line in enumerate(lines) if line.startswith(TRACEBACK)]
        if starts:
            # The frames are indented; a message may have many lines after its first.
            for line in lines[starts[-1] + 1 :]:
                if line.strip() and not line[0].isspace():
                    return line.strip()
        return next((line.strip() for line in reversed(lines) if line.strip()), "")

    def _append(self, content: bytes) -> bool:
        try:
            with self._path.open("ab") as file:
                file.write(content)
        except OSError:
            return False
        return True
