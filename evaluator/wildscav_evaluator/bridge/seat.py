"""One seat of a bridge: its socket, who may take it, and what becomes of its agent's requests."""

import asyncio
import secrets
import socket
from typing import Any

from wildscav.bridge import LONGEST_REQUEST, facts_of
from wildscav.errors import RefusedError, ServerUnreachableError
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_evaluator.bridge.agent_end import AgentEnd, ClosedError
from wildscav_evaluator.bridge.desk import Desk, RequestError
from wildscav_evaluator.bridge.keys import KeysDesk
from wildscav_evaluator.bridge.orders import Order
from wildscav_evaluator.bridge.words import WordsDesk

DESKS: dict[str, type[Desk]] = {"words": WordsDesk, "keys": KeysDesk}
MOST_CONNECTIONS = 64  # of an agent, before one of them has taken the seat


class SeatBridge:
    """Serves the agent of one seat. The first connection that knows the seat's token takes it for good.

    Args:
        order: The seat.
        failed: Gets what goes wrong in the bridge itself.
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

    async def _converse(self, agent: AgentEnd) -> None:
        """Play a seat as its agent asks, until that is over."""
        await self._greet(agent)
        order = self._order
        async with Connection(order.address, order.match_token, __version__) as connection:
            desk = DESKS[order.interface](connection, order.names)
            await agent.send({"match": facts_of(desk.match), **desk.told()})
            while True:
                steps = desk.steps
                try:
                    answer, content = await desk.answer(await agent.receive())
                except RequestError as refusal:
                    answer, content = {"error": str(refusal)}, b""
                if desk.steps > steps:
                    agent.idle = 0
                await agent.send(answer, content)

    async def _greet(self, agent: AgentEnd) -> None:
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
