"""The agent's end of a bridge: a unix socket, on which each request and each answer is a line of JSON.

A seat that plays by words or by keys has such a socket in place of the match's. docs/language.md describes
the protocol.
"""

import json
import math
import socket
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, Self

from wildscav.agent import MatchInfo
from wildscav.errors import AgentError, RefusedError, ServerUnreachableError
from wildscav.notes import begin_step

LONGEST_REQUEST = 65_536  # bytes, with the end of the line
# Facts that these seats do not get, and what stands in their place.
PLACES: dict[str, Any] = {"start": (math.nan,) * 3, "target": None, "supply_waves": ()}


class BridgedSeat:
    """A seat at a bridge (``unix:/path``): it has joined the match. Leaving the context leaves the seat.

    Attributes:
        match: What is known of the match, without its places: ``start`` is not a number, ``target`` is None,
            and ``supply_waves`` is empty.
        is_over: Whether the match is over.

    Raises:
        ServerUnreachableError: No bridge answers, or the connection was lost.
        RefusedError: The bridge has closed the connection; the message says why.
        AgentError: The bridge refuses a request; the message says what is allowed.
    """

    def __init__(self, address: str, token: str) -> None:
        self._address = address
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.connect(address.removeprefix("unix:"))
        except OSError as error:
            self._socket.close()
            raise ServerUnreachableError(f"no bridge answers at {address}: {error.strerror}") from None
        self._file = self._socket.makefile("rwb")
        self.is_over = False
        self.introduction, _ = self.ask("hello", token=token)  # of the match and the interface
        known = {field.name for field in fields(MatchInfo)}
        facts = {name: value for name, value in self.introduction["match"].items() if name in known}
        self.match = MatchInfo(**facts, **PLACES)

    def ask(self, request: str, **arguments: object) -> tuple[dict[str, Any], bytes]:
        """Send a request, and return the answer and the bytes that follow it."""
        try:
            line = json.dumps({"request": request, **arguments}, allow_nan=False).encode() + b"\n"
        except (TypeError, ValueError, RecursionError) as error:
            raise AgentError(f"a request must be JSON: {error}") from None
        if len(line) > LONGEST_REQUEST:
            raise AgentError(f"a request has {len(line):,} bytes, may have {LONGEST_REQUEST:,} at most")
        try:
            self._file.write(line)
            self._file.flush()
            line = self._file.readline()
            answer: dict[str, Any] = json.loads(line) if line else {}
            content = self._file.read(answer.get("bytes", 0))
        except OSError:
            line = b""
        if not line:
            raise ServerUnreachableError(f"{self._address} closed the connection before the match was over")
        if "closed" in answer:
            raise RefusedError("", answer["closed"])
        if "error" in answer:
            raise AgentError(answer["error"])
        self.is_over = answer.get("over", False)
        if "step" in answer:
            begin_step(answer["step"])
        return answer, content

    def close(self) -> None:
        """Leave the seat."""
        begin_step(None)
        self._file.close()
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def facts_of(match: MatchInfo) -> Mapping[str, Any]:
    """Return what a bridge tells of a match."""
    return {field.name: getattr(match, field.name) for field in fields(match) if field.name not in PLACES}
