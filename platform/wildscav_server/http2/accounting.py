"""What clients may cost: an account for each connection, and a share of time for unknown clients."""

import asyncio
from collections.abc import Callable

from wildscav_server.http2.frames import (
    FIRST_WINDOW,
    LARGEST_WINDOW,
    Code,
    FrameError,
    Kind,
    kind_name,
    write_frame,
)

# The allowance of one connection, in frames that complete no message:
UNKNOWN_ALLOWANCE = 400.0  # while its client is unknown
KNOWN_ALLOWANCE = 1000.0
REFILL_PER_SECOND = 20.0  # well-behaved clients send a ping now and then
REFILL_PER_MESSAGE = 4.0  # for each message that the server sends, which the client may acknowledge
BYTES_PER_FRAME = 2048  # sent bytes that refill one frame, because clients update their windows as they read
HEADERS_COST = 5.0  # of opening a stream
PAYLOAD_PER_FRAME = 256  # bytes of payload that cost as much as another frame
READ_COST = 0.25  # of each read, however few bytes it returns

UNKNOWN_LIMIT = 32_768  # bytes of messages that an unknown client may send before it gets an answer
WINDOW = 16_384  # bytes that a client may send on a stream before they are read


class FloodError(FrameError):
    """A client has exceeded its limits."""

    def __init__(self, message: str) -> None:
        super().__init__(Code.ENHANCE_YOUR_CALM, message)


class Account:
    """What one connection's client may still send, and what it still accepts.

    Frames that complete no message are paid from an allowance, a token bucket. A well-behaved client sends
    such frames to acknowledge what it receives, and a few others. So the allowance is refilled by what the
    client is sent, and slowly with time. Messages are limited by the windows of HTTP/2's flow control (RFC
    9113, 5.2).

    Args:
        on_known: Called once when the client identifies itself.
    """

    def __init__(self, send: Callable[[bytes], None], on_known: Callable[[], None]) -> None:
        self.send, self._on_known = send, on_known
        self._loop = asyncio.get_running_loop()
        self.known = False  # whether the client is in a seat, or an organizer
        self._limit = self._left = UNKNOWN_ALLOWANCE
        self._since = self._loop.time()  # when the allowance was last refilled with time
        self._unanswered = 0  # bytes of DATA since the last message that the server sent
        self.window = FIRST_WINDOW  # bytes that the client still accepts
        self.full = False  # whether the transport's write buffer is full
        self._waiters: set[asyncio.Future[None]] = set()  # of streams that wait to write
        self._unread = self._to_release = 0  # bytes: received and unread; read, but not yet reported as such

    def mark_authenticated(self) -> None:
        """Mark the client as known: it no longer uses the time of unknown clients."""
        if not self.known:
            self.known = True
            self._left += KNOWN_ALLOWANCE - self._limit
            self._limit = KNOWN_ALLOWANCE
            self._on_known()

    # The allowance.

    def spend(self, cost: float, kind: int | None = None) -> None:
        """Pay for a frame of some kind or a read, in frames; a FloodError if the allowance is used up."""
        self._left -= cost
        if self._left < 0.0:
            now = self._loop.time()
            self.refund((now - self._since) * REFILL_PER_SECOND)
            self._since = now
            if self._left < 0.0:
                last = None if kind is None else f"carry no message (the last was {kind_name(kind)})"
                which = last or "carry no message, or in pieces"
                raise FloodError(f"flooded its connection with frames that {which}")

    def refund(self, frames: float) -> None:
        """Give back a part of the allowance."""
        self._left = min(self._limit, self._left + frames)

    def refill(self, sent: int, *, begins: bool) -> None:
        """Refill the allowance for so many bytes that the server sends.

        They are a message, or a part of one; the first part ``begins`` it.
        """
        self.refund(begins * REFILL_PER_MESSAGE + sent / BYTES_PER_FRAME)
        self._unanswered = 0

    # From server to client.

    async def change(self) -> None:
        """Wait until more bytes may be sent, or a call has ended."""
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

    def grow_send_window(self, size: int) -> None:
        """Let the server send as many more bytes; a FrameError if the window becomes larger than allowed."""
        self.window = grown(self.window, size)

    # From client to server.

    def receive(self, size: int) -> None:
        """Count bytes that the client has sent.

        Raises:
            FrameError: It exceeds the connection's window; a FloodError if it is too much for an unknown
                client.
        """
        self._unanswered += size
        self._unread += size
        if self._unread > FIRST_WINDOW + WINDOW:
            raise FrameError(Code.FLOW_CONTROL_ERROR, "sent more than the connection's window")
        if not self.known and self._unanswered > UNKNOWN_LIMIT:
            raise FloodError(f"sent {self._unanswered:,} bytes without identifying itself")

    def release_received(self, size: int, stream: int = 0) -> None:
        """Let the client send as many bytes again as have been read, on a stream or the connection alone."""
        self._unread -= size
        self._to_release += size
        frames = write_frame(Kind.WINDOW_UPDATE, 0, stream, size.to_bytes(4, "big")) if stream else b""
        if self._to_release >= WINDOW:
            frames += write_frame(Kind.WINDOW_UPDATE, 0, 0, self._to_release.to_bytes(4, "big"))
            self._to_release = 0
        if frames:
            self.send(frames)


def grown(window: int, size: int) -> int:
    """Return a window that a client has enlarged, or raise a FrameError if it is larger than allowed."""
    if window + size > LARGEST_WINDOW:
        raise FrameError(Code.FLOW_CONTROL_ERROR, "opened a window too far")
    return window + size


SHARE = 0.25  # of a processor core, for all unknown clients at one address
BURST = 0.05  # s that they may take at once
# Estimated processor time of accepting a connection, and of one that is closed already, s:
CONNECTION_COST, GONE_COST = 300e-6, 20e-6


class TimeShare:
    """The share of the loop's time, by a clock in s, for clients neither in a seat nor organizers."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._left, self._since = clock, BURST, clock()

    def spend(self, cost: float) -> None:
        """Charge processor time, s, to the share."""
        self._refill()
        self._left -= cost

    def wait(self) -> float:
        """Return how long unknown clients must wait, s; 0 if they need not."""
        self._refill()
        return max(0.0, -self._left / SHARE)

    def _refill(self) -> None:
        now = self._clock()
        self._left = min(BURST, self._left + (now - self._since) * SHARE)
        self._since = now
