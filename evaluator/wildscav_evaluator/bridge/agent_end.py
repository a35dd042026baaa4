"""One agent's connection to the bridge. Whatever it sends is a request, or ends as a sentence about it."""

import asyncio
import json
from typing import Any

from wildscav.bridge import LONGEST_REQUEST
from wildscav_evaluator.bridge.desk import RequestError

MOST_IDLE = 100  # requests in a row for which no step is played


class ClosedError(Exception):
    """The agent's connection is over; the message says why."""


class AgentEnd:
    """The connection of an agent, with one request at a time.

    Attributes:
        idle: How many requests there were since the last step was played.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer
        self.idle = 0

    async def receive(self) -> dict[str, Any]:
        """Return the next request.

        Raises:
            RequestError: It is none.
            ClosedError: There are no more, or too many.
        """
        try:
            line = await self._reader.readline()
        except ValueError:  # asyncio's, if no line ends within the limit
            raise ClosedError(f"a request may have {LONGEST_REQUEST:,} bytes at most") from None
        if not line.endswith(b"\n"):
            raise ClosedError("the agent has left")
        self.idle += 1
        if self.idle > MOST_IDLE:
            raise ClosedError(f"{MOST_IDLE} requests in a row played no step")
        return _request_in(line)

    async def send(self, answer: dict[str, Any], content: bytes = b"") -> None:
        """Send an answer, and wait until the agent takes it.

        Args:
            answer: What the line says.
            content: The bytes that follow it, which the line announces.
        """
        line = json.dumps(answer | ({"bytes": len(content)} if content else {})).encode()
        self._writer.write(line + b"\n" + content)
        await self._writer.drain()

    def close(self, why: str) -> None:
        """Close the connection, and say why."""
        self._writer.write(json.dumps({"closed": why}).encode() + b"\n")
        self._writer.close()


def _request_in(line: bytes) -> dict[str, Any]:
    try:
        request = json.loads(line, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise RequestError("a request must be a line of JSON, encoded as UTF-8") from None
    if not isinstance(request, dict) or not isinstance(request.get("request"), str):
        raise RequestError('a request must be an object such as {"request": "observe"}')
    return request


def _refuse(constant: str) -> None:
    raise ValueError(constant)  # NaN and infinity are no JSON
