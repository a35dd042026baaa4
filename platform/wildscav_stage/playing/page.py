"""An open page: its WebSocket, by which messages go out and inputs come in."""

import asyncio
import json
import time
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from wildscav.errors import WildscavError

MAX_UNSEEN = 6  # moments on their way; more would wait in buffers, and be old when they are shown
MAX_MESSAGES = 600  # a second, from a page; displays show up to 360 pictures a second
MAX_WAITING = 200  # messages to a page that does not read them
LONGEST_REASON = 120  # bytes, of why a page is closed; the protocol allows 123
# Why a page is closed, as the protocol and our pages know it.
POLICY_VIOLATION, UNSUPPORTED = 1008, 1003
REPLACED, RENEWED, TOO_MANY, SEATED = 4001, 4002, 4003, 4006


class PageClosedError(WildscavError):
    """A page is to be closed, for a reason."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code, self.reason = code, reason


class Allowance:
    """How many things of a kind are taken in some s."""

    def __init__(self, most: int, seconds: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        self._most, self._seconds, self._clock = most, seconds, clock
        self._span = self._count = 0

    def count(self) -> bool:
        """Count one, and return whether it is within the allowance."""
        span = int(self._clock() / self._seconds)
        if span != self._span:
            self._span, self._count = span, 0
        self._count += 1
        return self._count <= self._most


class OpenPage:
    """What pages of players and of spectators have in common."""

    def __init__(self, socket: WebSocket) -> None:
        self._socket = socket
        self._messages: asyncio.Queue[dict[str, Any]] = asyncio.Queue(MAX_WAITING)
        self._sending = asyncio.Lock()
        self._told = asyncio.Event()  # set when there are messages
        self._sent = self._seen = 0  # numbers of moments
        self._has_seen = asyncio.Event()
        self._sent_at: dict[int, float] = {}  # when moments that were not seen were sent, s
        self.ping: int | None = None  # ms from sending a moment to hearing that it was received
        self._allowance = Allowance(MAX_MESSAGES)
        self._dismissed: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def tell(self, message: dict[str, Any]) -> None:
        """Send the page a message as soon as possible."""
        try:
            self._messages.put_nowait(message)
            self._told.set()
        except asyncio.QueueFull:
            self.dismiss(POLICY_VIOLATION, "the page does not read what it is sent")

    def dismiss(self, code: int, reason: str) -> None:
        """Close the page."""
        if not self._dismissed.done():
            self._dismissed.set_exception(PageClosedError(code, reason))

    async def _serve(self, *works: Coroutine[Any, Any, None]) -> None:
        """Send messages and do some works until one of them ends, or the page is closed."""
        tasks = [asyncio.create_task(work) for work in (*works, self._send_messages())]
        try:
            await asyncio.wait([*tasks, self._dismissed], return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            self._dismissed.cancel()  # does nothing if it was dismissed
            ended = await asyncio.gather(*tasks, self._dismissed, return_exceptions=True)
        await self._close(ended)

    async def _close(self, ended: list[Any]) -> None:
        for error in ended:
            if isinstance(error, PageClosedError):
                reason = error.reason.encode()[:LONGEST_REASON].decode(errors="ignore")
                return await self._socket.close(error.code, reason)
        for error in ended:
            if isinstance(error, Exception) and not isinstance(error, WebSocketDisconnect):
                raise error
        return None

    async def _send_messages(self) -> None:
        while True:
            await self._told.wait()
            async with self._sending:
                await self._flush()

    async def _flush(self) -> None:
        self._told.clear()
        while not self._messages.empty():
            await self._socket.send_text(json.dumps(self._messages.get_nowait()))

    async def _send_moment(self, kind: str, body: str) -> None:
        """Send what is to be seen now, after all messages, and wait until the page has seen the last ones.

        The body is JSON without the first brace.
        """
        self._sent += 1
        self._sent_at[self._sent] = time.monotonic()
        head = json.dumps({"kind": kind, "number": self._sent, "ping": self.ping})[:-1]
        async with self._sending:
            await self._flush()
            await self._socket.send_text(f"{head},{body}")
        while self._sent - self._seen >= MAX_UNSEEN:
            self._has_seen.clear()
            await self._has_seen.wait()

    def _note_seen(self, number: int) -> None:
        """Note that the page has received a moment."""
        if (sent := self._sent_at.get(number)) is not None:
            self.ping = round(1000.0 * (time.monotonic() - sent))
        self._sent_at = {other: when for other, when in self._sent_at.items() if other > number}
        self._seen = min(self._sent, max(self._seen, number))
        self._has_seen.set()

    async def _texts(self) -> AsyncIterator[str]:
        """Yield what the page sends.

        Raises:
            PageClosedError: It sends too much, or bytes.
        """
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                raise WebSocketDisconnect(message.get("code", 1005))
            if not self._allowance.count():
                raise PageClosedError(POLICY_VIOLATION, "too many messages")
            if message.get("text") is None:
                raise PageClosedError(UNSUPPORTED, "messages are texts")
            yield message["text"]
