"""A page as the server sees it: a WebSocket that reads what it is sent."""

import asyncio
import contextlib
import json
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

PATIENCE = 60.0  # s


class PageClient:
    """What a page does, without a browser."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.shown: dict[str, Any] = {}  # beside the last picture
        self.picture = b""  # the last one, JPEG
        self.pictures = 0

    async def send(self, **message: Any) -> None:
        await self.socket.send(json.dumps(message))

    async def until(self, kind: str) -> dict[str, Any]:
        """Read until there is a message of a kind; "picture" is one, too."""
        async with asyncio.timeout(PATIENCE):
            while True:
                message = await self.read()
                if message["kind"] == kind:
                    return message

    async def pictures_within(self, seconds: float) -> int:
        """Read for some time, and return how many pictures came."""
        before = self.pictures
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                while True:
                    await self.read()
        return self.pictures - before

    async def read(self) -> dict[str, Any]:
        """Read the next message or picture, and acknowledge pictures as pages do."""
        data = await self.socket.recv()
        if isinstance(data, str):
            message: dict[str, Any] = json.loads(data)
            return message
        (length,) = struct.unpack_from("<I", data)
        self.shown, self.picture = json.loads(data[4 : 4 + length]), data[4 + length :]
        self.pictures += 1
        await self.send(kind="seen", picture=self.shown["picture"])
        return {"kind": "picture", **self.shown}


@asynccontextmanager
async def page(link: str, **options: Any) -> AsyncIterator[PageClient]:
    """Open the WebSocket of a link."""
    async with connect(
        f"{link.replace('http:', 'ws:')}/socket", **{"proxy": None, "max_queue": None, **options}
    ) as socket:
        yield PageClient(socket)
