"""The file of what seats asked and what the model answered: compressed lines of JSON, beside the record.

Each message and each list of tools stands in the file once, under its digest; requests name the digests,
because every request repeats the conversation before it.
"""

import asyncio
import gzip
import json
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from hashlib import sha256
from pathlib import Path
from typing import Any

from pydantic_core import to_json

MOST = 64 << 20  # bytes of a seat's lines, before they are compressed
SHORT = 16  # hexadecimal digits of a digest


class Exchanges:
    """Writes the file, if any, in a thread, as a context manager, until a seat has filled its share."""

    def __init__(self, path: Path | None) -> None:
        self._stack = ExitStack()
        self._file: gzip.GzipFile | None = None
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            plain = self._stack.enter_context(path.open("wb"))
            self._file = gzip.GzipFile(filename="", fileobj=plain, mode="wb", compresslevel=1, mtime=0)
            self._stack.enter_context(self._file)
        self._thread = self._stack.enter_context(ThreadPoolExecutor(1))
        self._known: dict[int, set[str]] = {}
        self._left: dict[int, int] = {}

    def __enter__(self) -> "Exchanges":
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def write(
        self, seat: int, number: int, request: dict[str, Any], result: dict[str, Any]
    ) -> "asyncio.Future[None]":
        """Write a seat's request, its number from 1, and what became of it, also if nobody waits for that."""
        loop = asyncio.get_running_loop()
        return loop.run_in_executor(self._thread, self._write, seat, number, request, result)

    def _write(self, seat: int, number: int, request: dict[str, Any], result: dict[str, Any]) -> None:
        if self._file is None or self._left.get(seat, MOST) <= 0:
            return
        short = dict(request)
        if "messages" in short:
            short["messages"] = [self._refer(seat, message) for message in short["messages"]]
        if "tools" in short:
            short["tools"] = self._refer(seat, short["tools"])
        self._line(seat, {"seat": seat, "number": number, "request": short, **result})

    def _refer(self, seat: int, value: Any) -> str:
        """Return the digest of a value, which stands in the file from now on."""
        name = sha256(to_json(value)).hexdigest()[:SHORT]
        known = self._known.setdefault(seat, set())
        if name not in known:
            known.add(name)
            self._line(seat, {"seat": seat, "digest": name, "is": value})
        return name

    def _line(self, seat: int, document: dict[str, Any]) -> None:
        line = json.dumps(document).encode("ascii") + b"\n"
        left = self._left.get(seat, MOST)
        if self._file is not None and left > 0:
            self._left[seat] = left - len(line)
            self._file.write(line if len(line) <= left else b'{"seat": %d, "cut": true}\n' % seat)
