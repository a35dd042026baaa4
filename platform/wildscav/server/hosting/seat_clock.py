"""The time that seats are charged by."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager


class SeatClock:
    """The event loop's time, less what the server has spent on reading sensors.

    Answers lie unread while a sensor is read, whichever match it is for. So the clocks of all seats stand
    still then, and the seat that asked for the sensor is charged for it.
    """

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._stood = 0.0  # s

    def now(self) -> float:
        """Return the time, s."""
        return self._loop.time() - self._stood

    def on_loop(self, when: float) -> float:
        """Return a time by the loop's clock, if no sensor is read until then."""
        return when + self._stood

    @contextmanager
    def standing_still(self) -> Iterator[None]:
        """Stop the clock for as long as the block lasts."""
        began = self._loop.time()
        try:
            yield
        finally:
            self._stood += self._loop.time() - began
