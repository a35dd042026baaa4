"""Pending streams: streams that have not joined a seat yet. Their number is limited."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager

import grpc

from wildscav.wire.errors import RefusalError

PENDING_LIMIT = 256  # at one time


class PendingStreams:
    """The pending streams of an endpoint. When there are too many, the oldest one is refused.

    Agents join at once, so the oldest streams are not those of agents.
    """

    def __init__(self, limit: int = PENDING_LIMIT) -> None:
        self._limit = limit
        self._tasks: dict[asyncio.Task[None], None] = {}  # in the order of their arrival
        self._evicted: set[asyncio.Task[None]] = set()

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._tasks)

    @contextmanager
    def counted(self, task: "asyncio.Task[None]") -> Iterator[None]:
        """Count a stream as pending during the block.

        Args:
            task: The task that serves the stream and runs the block.

        Raises:
            RefusalError: It was evicted to make room for another one.
        """
        if len(self._tasks) >= self._limit:
            oldest = next(iter(self._tasks))
            del self._tasks[oldest]
            self._evicted.add(oldest)
            oldest.cancel()
        self._tasks[task] = None
        try:
            yield
        except asyncio.CancelledError:
            if task not in self._evicted:  # its connection was lost
                raise
            raise RefusalError(
                grpc.StatusCode.RESOURCE_EXHAUSTED,
                "SERVER_BUSY",
                f"more than {self._limit} streams have not joined; send the Join sooner",
            ) from None
        finally:
            self._tasks.pop(task, None)
            self._evicted.discard(task)
