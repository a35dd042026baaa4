"""One open page: its WebSocket, by which pictures and messages go out and inputs come in."""

import asyncio
import json
import struct
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from wildscav.play.inputs import Input, InputError, Pause, Seen, Start, decode_message
from wildscav.play.table import Table

MOST_UNSEEN = 2  # pictures on their way; more would wait in buffers, and be old when they are shown
MOST_MESSAGES = 300  # a second, from a page
POLICY_VIOLATION, UNSUPPORTED, REPLACED = 1008, 1003, 4001  # close codes; the last is for our page


class Page:
    """Serves a page until it is closed.

    Args:
        socket: The page's connection, which was accepted.
        table: The table at which its person plays.
    """

    def __init__(self, socket: WebSocket, table: Table) -> None:
        self._socket, self._table = socket, table
        self._messages: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._sending = asyncio.Lock()
        self._sent = self._seen = 0  # numbers of pictures
        self._has_seen = asyncio.Event()
        self._second, self._received = 0, 0
        self._tasks: list[asyncio.Task[None]] = []
        self._replaced = False

    async def serve(self) -> None:
        """Serve the page until it is closed, or another page takes its place."""
        self._table.attach(self._tell)
        works = (self._receive(), self._send_messages(), self._send_pictures())
        self._tasks = [asyncio.create_task(work) for work in works]
        try:
            await asyncio.wait(self._tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in self._tasks:
                task.cancel()
            if not self._replaced:
                self._table.detach(self._tell)
            ended = await asyncio.gather(*self._tasks, return_exceptions=True)
        for error in ended:
            if isinstance(error, Exception) and not isinstance(error, WebSocketDisconnect):
                raise error

    async def replace(self) -> None:
        """Close the page because the same link was opened in another one."""
        self._replaced = True
        await self._socket.close(REPLACED, "the link was opened elsewhere")
        for task in self._tasks:
            task.cancel()

    def _tell(self, message: dict[str, Any]) -> None:
        self._messages.put_nowait(message)

    async def _send_messages(self) -> None:
        while True:
            text = json.dumps(await self._messages.get())
            async with self._sending:
                await self._socket.send_text(text)

    async def _send_pictures(self) -> None:
        """Send a picture whenever there is something new to see, and the page has shown the last ones."""
        loop, table = asyncio.get_running_loop(), self._table
        # A thread of its own, which keeps the memory that pictures are made in.
        with ThreadPoolExecutor(1, "pictures") as painter:
            while True:
                view = await table.person.look()
                picture = await loop.run_in_executor(painter, table.eyes.picture, view.moment)
                self._sent += 1
                head = json.dumps({"picture": self._sent, "input": view.taken, **view.display}).encode()
                async with self._sending:
                    # The length of the head, little-endian; the head, JSON; the picture, JPEG.
                    await self._socket.send_bytes(struct.pack("<I", len(head)) + head + picture)
                while self._sent - self._seen >= MOST_UNSEEN:
                    self._has_seen.clear()
                    await self._has_seen.wait()

    async def _receive(self) -> None:
        while True:
            text = await self._socket.receive_text()
            if self._is_flood():
                return await self._socket.close(POLICY_VIOLATION, "too many messages")
            try:
                message = decode_message(text)
            except InputError as error:
                return await self._socket.close(UNSUPPORTED, str(error)[:120])
            match message:
                case Input():
                    self._table.person.controls.receive(message)
                case Seen():
                    self._seen = min(self._sent, max(self._seen, message.picture))
                    self._has_seen.set()
                case Start():
                    self._table.start()
                case Pause():
                    self._table.pause(message.paused)

    def _is_flood(self) -> bool:
        """Count a message, and return whether there were too many in this second."""
        second = int(time.monotonic())
        if second != self._second:
            self._second, self._received = second, 0
        self._received += 1
        return self._received > MOST_MESSAGES
