"""The flow control of one connection (RFC 9113, 5.2): how much the client takes, and how much it may send."""

import asyncio
from collections.abc import Callable
from typing import Protocol

from wildscav.server.http2.frames import FIRST_WINDOW, LARGEST_WINDOW, Code, FrameError, Kind, write_frame

WINDOW = 16_384  # bytes that a client may have sent of a stream and that nobody has read


class StreamLostError(Exception):
    """The connection of a stream is gone, or its client has ended it."""


class StreamWindow(Protocol):
    """What flow control needs of a stream."""

    window: int  # bytes that the client takes of it
    finished: bool  # whether nothing more is sent of it


class FlowControl:
    """What may still be sent on a connection, either way.

    Args:
        send: Sends frames to the client.
    """

    def __init__(self, send: Callable[[bytes], None]) -> None:
        self._send = send
        self._loop = asyncio.get_running_loop()
        self.window = FIRST_WINDOW  # bytes that the client takes
        self.full = False  # whether nothing more is to be written until some has gone
        self._waiters: set[asyncio.Future[None]] = set()  # of those who wait for room
        self._arrived = self._room = 0  # bytes: unread of the connection, and to be made room for

    # What the client takes.

    async def room_for(self, stream: StreamWindow) -> None:
        """Wait until there is room for some of a stream.

        Raises:
            StreamLostError: The stream has ended, or its connection is gone.
        """
        while self.full or self.window <= 0 or stream.window <= 0:
            if stream.finished:
                raise StreamLostError
            waiter: asyncio.Future[None] = self._loop.create_future()
            self._waiters.add(waiter)
            try:
                await waiter
            finally:
                self._waiters.discard(waiter)

    def wake(self) -> None:
        """Have those who wait for room look again."""
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)

    def widen(self, more: int, stream: StreamWindow | None) -> None:
        """Hear that the client takes more.

        Args:
            more: Bytes.
            stream: Of this stream; none: of the connection.

        Raises:
            FrameError: That is more than a window can be.
        """
        if stream is None:
            self.window += more
            size = self.window
        else:
            stream.window += more
            size = stream.window
        if size > LARGEST_WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "opened a window too far")
        self.wake()

    # What it may send.

    def arrive(self, size: int) -> None:
        """Count what the client has sent.

        Args:
            size: Bytes.

        Raises:
            FrameError: There was no room for it.
        """
        self._arrived += size
        if self._arrived > FIRST_WINDOW + WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than there was room for")

    def make_room(self, size: int, stream: int) -> None:
        """Let the client send more.

        Args:
            size: Bytes that need no more place.
            stream: Of this stream, too; 0: of the connection alone.
        """
        self._arrived -= size
        self._room += size
        frames = write_frame(Kind.WINDOW_UPDATE, 0, stream, size.to_bytes(4, "big")) if stream else b""
        if self._room >= WINDOW:
            frames += write_frame(Kind.WINDOW_UPDATE, 0, 0, self._room.to_bytes(4, "big"))
            self._room = 0
        if frames:
            self._send(frames)
