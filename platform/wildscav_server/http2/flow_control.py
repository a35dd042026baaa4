"""The flow control of one connection (RFC 9113, 5.2): how much may still be sent in each direction."""

import asyncio
from collections.abc import Callable
from typing import Protocol

from wildscav_server.http2.frames import FIRST_WINDOW, LARGEST_WINDOW, Code, FrameError, Kind, write_frame

WINDOW = 16_384  # bytes that a client may send on a stream before they are read


class StreamLostError(Exception):
    """The connection of a stream is gone, or its client has ended it."""


class StreamWindow(Protocol):
    """The part of a stream that flow control needs."""

    window: int  # bytes that the client still accepts on it
    finished: bool  # whether nothing more is sent on it


class FlowControl:
    """How much may still be sent on a connection, in both directions.

    Args:
        send: Sends frames to the client.
    """

    def __init__(self, send: Callable[[bytes], None]) -> None:
        self._send = send
        self._loop = asyncio.get_running_loop()
        self.window = FIRST_WINDOW  # bytes that the client still accepts
        self.full = False  # whether the transport's write buffer is full
        self._waiters: set[asyncio.Future[None]] = set()  # of streams that wait to write
        self._unread = self._to_reopen = 0  # bytes: received and unread; read, but not yet reported as such

    # From server to client.

    async def wait_for_window(self, stream: StreamWindow) -> None:
        """Wait until some bytes may be sent on a stream.

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
        """Make waiting streams check again whether they may write."""
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)

    def widen(self, more: int, stream: StreamWindow | None) -> None:
        """Enlarge a window because the client accepts more.

        Args:
            more: Bytes.
            stream: The window's stream; None for the connection's window.

        Raises:
            FrameError: The window becomes larger than allowed.
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

    # From client to server.

    def receive(self, size: int) -> None:
        """Count data that the client has sent.

        Args:
            size: Bytes.

        Raises:
            FrameError: It exceeds the connection's window.
        """
        self._unread += size
        if self._unread > FIRST_WINDOW + WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than the connection's window")

    def reopen(self, size: int, stream: int) -> None:
        """Let the client send as much again as has been read.

        Args:
            size: Bytes.
            stream: The stream whose window is reopened with the connection's; 0: only the connection's.
        """
        self._unread -= size
        self._to_reopen += size
        frames = write_frame(Kind.WINDOW_UPDATE, 0, stream, size.to_bytes(4, "big")) if stream else b""
        if self._to_reopen >= WINDOW:
            frames += write_frame(Kind.WINDOW_UPDATE, 0, 0, self._to_reopen.to_bytes(4, "big"))
            self._to_reopen = 0
        if frames:
            self._send(frames)
