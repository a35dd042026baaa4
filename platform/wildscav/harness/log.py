"""What was asked and answered, as JSON lines, for people who want to know why a model played as it did.

Each request has the messages that are new since the one before: the first ``kept`` are those of it. Its other
fields stand there if they are new.
"""

import hashlib
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

LARGEST = 256 << 20  # bytes of a log
LEFT_OUT = "(key)"  # in place of the key, wherever it stands
SHORTEST_KEY = 8  # characters; what is shorter is a placeholder for a server that wants no key


class Log:
    """Writes the requests and answers of a match into a new file, if there is one, but never the key."""

    def __init__(self, path: Path | None, key: str) -> None:
        self._path, self._key = path, json.dumps(key)[1:-1]
        self._began, self._size = time.monotonic(), 0
        self._last: Sequence[Any] = ()
        self._others: Mapping[str, Any] = {}
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(b"")

    def asked(self, messages: Sequence[Mapping[str, Any]], others: Mapping[str, Any]) -> None:
        """Note a request: its messages, and its other fields."""
        if self._path is None:
            return
        plain = [_without_pictures(message) for message in messages]
        pairs = enumerate(zip(plain, self._last, strict=False))
        kept = next((place for place, (new, old) in pairs if new != old), min(len(plain), len(self._last)))
        new = {} if others == self._others else others
        self._last, self._others = plain, others
        self._write("asked", {"kept": kept, "messages": plain[kept:], **new})

    def answered(self, document: object, seconds: float) -> None:
        """Note an answer, and how many seconds it took."""
        self._write("answered", {"answer": document, "seconds": round(seconds, 3)})

    def failed(self, reason: str, status: int, seconds: float) -> None:
        """Note that a request was not answered."""
        self._write("failed", {"reason": reason, "status": status, "seconds": round(seconds, 3)})

    def ended(self, ending: str, figures: Mapping[str, Any]) -> None:
        """Note how the model's play has ended."""
        self._write("ended", {"ending": ending, **figures})

    def _write(self, kind: str, content: Mapping[str, Any]) -> None:
        if self._path is None:
            return
        line = json.dumps({"at": round(time.monotonic() - self._began, 3), "kind": kind, **content}) + "\n"
        line = line.replace(self._key, LEFT_OUT) if len(self._key) >= SHORTEST_KEY else line
        self._size += len(line)
        if self._size <= LARGEST:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(line)


def _without_pictures(message: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a message with the digests of its pictures, which can be drawn again from the match's record."""
    content = message.get("content")
    if not isinstance(content, list):
        return message
    return {**message, "content": [_described(part) for part in content]}


def _described(part: Mapping[str, Any]) -> Mapping[str, Any]:
    if part["type"] != "image_url":
        return part
    data = part["image_url"]["url"].encode()
    return {"type": "image_url", "blake2b": hashlib.blake2b(data, digest_size=16).hexdigest()}
