"""The clock by which seats are charged for their time."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager


class SeatClock:
    """The event loop's time minus the time that the server has spent on reading sensors.

    While a sensor is read, answers in all matches stay unread. So this clock stops for all seats, and the
    seat that asked for the sensor is charged separately.
    """

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._stopped = 0.0  # s that the clock has been stopped in all

    def now(self) -> float:
        """Return the time, s."""
        return self._loop.time() - self._stopped

    def on_loop(self, when: float) -> float:
        """Convert a time to the loop's clock, assuming that no sensor is read until then."""
        return when + self._stopped

    @contextmanager
    def standing_still(self) -> Iterator[None]:
        """Stop the clock during the block."""
        began = self._loop.time()
        try:
            yield
        finally:
            self._stopped += self._loop.time() - began
