"""One seat of a bridge: its socket, the connection that takes it, and what becomes of requests."""

import asyncio
import json
import secrets
import socket
from typing import Any

from wildscav.bridge import LONGEST_REQUEST, facts_of
from wildscav.errors import RefusedError, ServerUnreachableError
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_evaluator.bridge.desk import Desk, Order, RequestError
from wildscav_evaluator.bridge.keys import KeysDesk
from wildscav_evaluator.bridge.words import WordsDesk

DESKS: dict[str, type[Desk]] = {"words": WordsDesk, "keys": KeysDesk}
MOST_IDLE = 100  # requests in a row for which no step is played
MOST_CONNECTIONS = 64  # of an agent, before one of them has taken the seat


class SeatBridge:
    """Serves the agent of one seat. The first connection that knows the seat's token takes it for good.

    ``failed`` gets what goes wrong in the bridge itself.
    """

    def __init__(self, order: Order, failed: "asyncio.Future[Any]") -> None:
        self._order, self._failed = order, failed
        self._listening: asyncio.Server
        self._connections = 0
        self._is_taken = False

    async def listen(self) -> None:
        """Serve connections to the socket from now on."""
        listener = socket.socket(fileno=self._order.socket)
        self._listening = await asyncio.start_unix_server(self._serve, sock=listener, limit=LONGEST_REQUEST)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._connections += 1
        if self._connections == MOST_CONNECTIONS:
            self._listening.close()
        agent = AgentEnd(reader, writer)
        try:
            await self._converse(agent)
        except (ClosedError, RefusedError, ServerUnreachableError) as end:
            agent.close(str(end))
        except OSError:
            pass  # the agent has gone
        except Exception as error:  # noqa: BLE001 - whatever it is, it is a fault of the bridge
            if not self._failed.done():
                self._failed.set_exception(error)
        finally:
            writer.close()

    async def _converse(self, agent: "AgentEnd") -> None:
        """Play a seat as its agent asks, until that is over."""
        await self._greet(agent)
        order = self._order
        async with Connection(order.address, order.match_token, __version__) as connection:
            desk = DESKS[order.interface](connection, order.names)
            await agent.send({"match": facts_of(desk.match), **desk.introduction()})
            while True:
                steps = desk.steps
                try:
                    answer, content = await desk.answer(await agent.receive())
                except RequestError as refusal:
                    answer, content = {"error": str(refusal)}, b""
                if desk.steps > steps:
                    agent.idle = 0
                await agent.send(answer, content)

    async def _greet(self, agent: "AgentEnd") -> None:
        """Wait for the seat's token."""
        try:
            hello = await agent.receive()
        except RequestError as refusal:
            raise ClosedError(str(refusal)) from None
        token = hello.get("token")
        if hello["request"] != "hello" or not isinstance(token, str) or not self._is_right(token):
            raise ClosedError('the first request must be "hello", with the token of the seat')
        if self._is_taken:
            raise ClosedError("another connection has taken this seat")
        self._is_taken = True
        self._listening.close()

    def _is_right(self, token: str) -> bool:
        return secrets.compare_digest(token.encode(errors="replace"), self._order.token.encode())


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
        """Send an answer and the bytes that follow it, and wait until the agent takes them."""
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
