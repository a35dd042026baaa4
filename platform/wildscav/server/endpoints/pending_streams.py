"""Streams that have not said yet which seat they are: no more than so many at a time."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager

import grpc

from wildscav.wire.errors import RefusalError

STRANGERS = 256  # at one time


class Strangers:
    """The strangers of a server. When there are too many, the one who has said nothing for longest has to go.

    An agent says at once who it is, so those who come to sit here make room for it.
    """

    def __init__(self, limit: int = STRANGERS) -> None:
        self._limit = limit
        self._tasks: dict[asyncio.Task[None], None] = {}  # in the order in which they came
        self._sent_away: set[asyncio.Task[None]] = set()

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._tasks)

    @contextmanager
    def counted(self, task: "asyncio.Task[None]") -> Iterator[None]:
        """Count a stream as a stranger for as long as the block lasts.

        Args:
            task: Serves it, and runs the block.

        Raises:
            RefusalError: It had to make room.
        """
        if len(self._tasks) >= self._limit:
            oldest = next(iter(self._tasks))
            del self._tasks[oldest]
            self._sent_away.add(oldest)
            oldest.cancel()
        self._tasks[task] = None
        try:
            yield
        except asyncio.CancelledError:
            if task not in self._sent_away:  # its connection was lost
                raise
            raise RefusalError(
                grpc.StatusCode.RESOURCE_EXHAUSTED,
                "SERVER_BUSY",
                f"more than {self._limit} streams have not joined; say sooner who you are",
            ) from None
        finally:
            self._tasks.pop(task, None)
            self._sent_away.discard(task)
