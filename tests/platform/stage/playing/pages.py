"""A page as the server sees it: a WebSocket that reads what it is sent."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

PATIENCE = 60.0  # s
MOMENTS = ("now", "all")  # kinds of messages about the match, to people and to spectators


class PageClient:
    """What a page does, without a browser."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.shown: dict[str, Any] = {}  # the last moment of the match
        self.boxes: set[int] = set()  # serials of those that are known
        self.rows: dict[int, list[int]] = {}  # of agents, as spectators are told them
        self.moments = 0
        self.texts: list[str] = []  # all that it was sent

    async def send(self, **message: Any) -> None:
        await self.socket.send(json.dumps(message))

    async def until(self, kind: str) -> dict[str, Any]:
        """Read until there is a message of a kind; "moment" is one, too."""
        async with asyncio.timeout(PATIENCE):
            while True:
                message = await self.read()
                if message["kind"] == kind or (kind == "moment" and message["kind"] in MOMENTS):
                    return message

    async def moments_within(self, seconds: float) -> int:
        """Read for some time, and return how many moments came."""
        before = self.moments
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                while True:
                    await self.read()
        return self.moments - before

    async def read(self) -> dict[str, Any]:
        """Read the next message, and acknowledge moments as pages do."""
        text = await self.socket.recv()
        assert isinstance(text, str)
        self.texts.append(text)
        message: dict[str, Any] = json.loads(text)
        if message["kind"] in MOMENTS:
            self.shown = message
            self.boxes |= {box[0] for box in message.get("boxes", ())}
            self.boxes -= set(message.get("gone", ()))
            self._take_rows(message)
            self.moments += 1
            await self.send(kind="seen", number=message["number"])
        return message

    def _take_rows(self, message: dict[str, Any]) -> None:
        """Take in what spectators are told of agents."""
        if message.get("all"):
            self.rows = {seat: row for seat, *row in message["agents"]}
        for seat in message.get("left", ()):
            del self.rows[seat]
        for seat, bits, *changes in message.get("moved", ()):
            for place in range(len(self.rows[seat])):
                if bits >> place & 1:
                    self.rows[seat][place] += changes.pop(0)


@asynccontextmanager
async def page(link: str, **options: Any) -> AsyncIterator[PageClient]:
    """Open the WebSocket of a link."""
    async with connect(
        f"{link.replace('http:', 'ws:')}/socket", **{"proxy": None, "max_queue": None, **options}
    ) as socket:
        yield PageClient(socket)
