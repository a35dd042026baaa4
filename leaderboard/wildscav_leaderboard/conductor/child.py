"""A child process for work that may take the process with it: building and validating submissions."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from wildscav.errors import WildscavError
from wildscav.system.worker_pool import WorkerPool

Value = TypeVar("Value")


class ChildError(WildscavError):
    """The child process died, or was ended because it took too long."""


class Child:
    """One child process, started when it is needed, and again when it is gone, until ``close``.

    One thread calls functions in it; any other may close it meanwhile.
    """

    def __init__(self) -> None:
        self._pool: WorkerPool | None = None
        self._closed, self._lock = False, threading.RLock()

    def close(self) -> None:
        """End the child, whatever it is doing, and start none again."""
        with self._lock:
            self._closed = True
            self._end()

    def call(self, function: Callable[..., Value], *arguments: Any, timeout: float) -> Value:
        """Call a function of a module in the child, and return its value.

        Args:
            function: The function; it gets and returns what can be pickled, and its errors are raised here.
            arguments: Its arguments.
            timeout: How long it may take, s.

        Raises:
            ChildError: The child died, took longer, or was closed.
        """
        future = self._begin(function, *arguments)
        try:
            return future.result(timeout)
        except TimeoutError:
            if future.done():
                raise
            self._end()
            raise ChildError(f"it did not end within {timeout:,.0f} s") from None
        except BrokenProcessPool:
            self._end()
            raise ChildError("the process that worked on it died") from None

    def _begin(self, function: Callable[..., Value], *arguments: Any) -> Future[Value]:
        with self._lock:
            if self._closed:
                raise ChildError("it was closed")
            if self._pool is None:
                self._pool = WorkerPool(1)
            return self._pool.submit(function, *arguments)

    def _end(self) -> None:
        """Kill the child. What it started ends with it, or is swept away by the next sandbox."""
        with self._lock:
            if self._pool is None:
                return
            pool, self._pool = self._pool, None
            pool.kill()
