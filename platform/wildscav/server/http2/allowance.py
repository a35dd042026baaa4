"""What clients may cost: an allowance for each connection, and a share of the time for unknown clients."""

import time
from collections.abc import Callable

from wildscav.server.http2.frames import Code, FrameError

# Of one connection, in frames that carry no whole message; reading has its cost, too:
UNKNOWN = 400.0  # while its client is unknown
MOST = 1000.0
A_SECOND = 20.0  # that come back; honest clients send a ping now and then
A_MESSAGE = 4.0  # that come back for every message that the server sends: each may be acknowledged
BYTES = 2048  # sent, for which one more comes back: clients open their windows again as they read
HEADERS_COST = 5.0  # of a stream's beginning
HEAVY = 256  # bytes of a payload that cost as much as another frame
READ_COST = 0.25  # of a piece, however small, that had to be read by itself


class FloodError(FrameError):
    """A peer has gone beyond its allowance."""

    def __init__(self, message: str) -> None:
        super().__init__(Code.ENHANCE_YOUR_CALM, message)


class Allowance:
    """How many frames without a message a connection may still send.

    An honest client sends such frames to acknowledge what it receives, and a few besides. So the allowance
    grows with what the client is sent, and slowly with time.

    Args:
        clock: Tells the time, s.
    """

    __slots__ = ("_clock", "_left", "_most", "_since")

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._most, self._left, self._since = clock, UNKNOWN, UNKNOWN, clock()

    def spend(self, cost: float, kind: str = "") -> None:
        """Pay for a frame, or for having read something.

        Args:
            cost: In frames.
            kind: Of the frame; empty if something was read.

        Raises:
            FloodError: There is nothing left to pay with.
        """
        self._left -= cost
        if self._left < 0.0:
            now = self._clock()
            self._left = min(self._most, self._left + (now - self._since) * A_SECOND)
            self._since = now
            if self._left < 0.0:
                which = f"say nothing ({kind} the last of them)" if kind else "say nothing or come in scraps"
                raise FloodError(f"flooded its connection with frames that {which}")

    def earn(self, sent: int) -> None:
        """Give back what a message of the server's is worth.

        Args:
            sent: Its size, bytes.
        """
        self._left = min(self._most, self._left + A_MESSAGE + sent / BYTES)

    def widen(self) -> None:
        """Give a connection what it may spend from the time on that its client is known."""
        self._left += MOST - self._most
        self._most = MOST


SHARE = 0.25  # of a processor core, for all unknown clients at one address
BURST = 0.05  # s that they may take at once
# s that a connection is taken to cost before it has sent anything, and one that is gone at once:
CONNECTION_COST, GONE_COST = 300e-6, 20e-6


class Share:
    """The time that unknown clients may take of the loop: those who are neither in a seat nor organizers.

    Args:
        clock: Tells the time, s.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._left, self._since = clock, BURST, clock()

    def spend(self, cost: float) -> None:
        """Pay for something.

        Args:
            cost: Processor time, s.
        """
        self._refill()
        self._left -= cost

    def wait(self) -> float:
        """Return for how long nothing more is to be done for unknown clients, s; 0: not at all."""
        self._refill()
        return max(0.0, -self._left / SHARE)

    def _refill(self) -> None:
        now = self._clock()
        self._left = min(BURST, self._left + (now - self._since) * SHARE)
        self._since = now


processor_time = time.thread_time  # s of this thread's
