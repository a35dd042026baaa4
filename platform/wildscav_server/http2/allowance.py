"""Limits of clients: an allowance of frames for each connection, and a share of time for unknown clients."""

import time
from collections.abc import Callable

from wildscav_server.http2.frames import Code, FrameError

# The allowance of one connection, in frames that complete no message:
UNKNOWN_ALLOWANCE = 400.0  # while its client is unknown
KNOWN_ALLOWANCE = 1000.0
REFILL_PER_SECOND = 20.0  # well-behaved clients send a ping now and then
REFILL_PER_MESSAGE = 4.0  # for each message that the server sends, which the client may acknowledge
BYTES_PER_FRAME = 2048  # sent bytes that refill one frame, because clients update their windows as they read
HEADERS_COST = 5.0  # of opening a stream
PAYLOAD_PER_FRAME = 256  # bytes of payload that cost as much as another frame
READ_COST = 0.25  # of each read, however few bytes it returns


class FloodError(FrameError):
    """A client has exceeded its limits."""

    def __init__(self, message: str) -> None:
        super().__init__(Code.ENHANCE_YOUR_CALM, message)


class Allowance:
    """How many frames that complete no message a connection may still send: a token bucket.

    A well-behaved client sends such frames to acknowledge what it receives, and a few others. So the
    allowance is refilled by what the client is sent, and slowly with time.

    Args:
        clock: Returns the time, s.
    """

    __slots__ = ("_clock", "_left", "_limit", "_since", "unanswered")

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._since = clock, clock()
        self._limit = self._left = UNKNOWN_ALLOWANCE
        self.unanswered = 0  # bytes of DATA since the last message that the server sent

    def spend(self, cost: float, kind: str = "") -> None:
        """Pay for a frame or for a read.

        Args:
            cost: The cost in frames.
            kind: The kind of the frame; empty for a read.

        Raises:
            FloodError: The allowance is used up.
        """
        self._left -= cost
        if self._left < 0.0:
            now = self._clock()
            self._left = min(self._limit, self._left + (now - self._since) * REFILL_PER_SECOND)
            self._since = now
            if self._left < 0.0:
                which = (
                    f"carry no message (the last was {kind})" if kind else "carry no message, or in pieces"
                )
                raise FloodError(f"flooded its connection with frames that {which}")

    def refill(self, sent: int) -> None:
        """Refill the allowance for a message that the server sends.

        Args:
            sent: The message's size, bytes.
        """
        self._left = min(self._limit, self._left + REFILL_PER_MESSAGE + sent / BYTES_PER_FRAME)
        self.unanswered = 0

    def raise_limit(self) -> None:
        """Raise the allowance to that of a known client."""
        self._left += KNOWN_ALLOWANCE - self._limit
        self._limit = KNOWN_ALLOWANCE


SHARE = 0.25  # of a processor core, for all unknown clients at one address
BURST = 0.05  # s that they may take at once
# Estimated processor time of accepting a connection, and of one that is closed already, s:
CONNECTION_COST, GONE_COST = 300e-6, 20e-6


class TimeShare:
    """The share of the loop's time for unknown clients, which are neither in a seat nor organizers.

    Args:
        clock: Returns the time, s.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._left, self._since = clock, BURST, clock()

    def spend(self, cost: float) -> None:
        """Charge processor time to the share.

        Args:
            cost: Processor time, s.
        """
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


processor_time = time.thread_time  # of this thread, s
