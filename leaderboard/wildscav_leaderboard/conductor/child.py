"""A child process for work that may take the process with it: building and validating submissions."""

import multiprocessing
import os
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import Any, Self, TypeVar

from wildscav.errors import WildscavError
from wildscav.system.worker_processes import become_worker, starting_workers

Value = TypeVar("Value")


class ChildError(WildscavError):
    """The child process died, or was ended because it took too long."""


class Child:
    """One child process, started when it is needed, and again when it is gone. A context manager."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def call(self, function: Callable[..., Value], *arguments: Any, timeout: float) -> Value:
        """Call a function of a module in the child, and return its value.

        Args:
            function: The function; it gets and returns what can be pickled, and its errors are raised here.
            arguments: Its arguments.
            timeout: How long it may take, s.

        Raises:
            ChildError: The child died, or took longer.
        """
        if self._pool is None:
            spawn = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(1, spawn, become_worker, (os.getpid(),))
        try:
            with starting_workers():
                future = self._pool.submit(function, *arguments)
            return future.result(timeout)
        except TimeoutError:
            if not future.done():
                self._end()
                raise ChildError(f"it did not end within {timeout:,.0f} s") from None
            raise
        except BrokenProcessPool:
            self._end()
            raise ChildError("the process that worked on it died") from None
        except BaseException as error:
            if not isinstance(error, Exception):  # interrupted
                self._end()
            raise

    def _end(self) -> None:
        """Kill the child. What it started ends with it, or is swept away by the next sandbox."""
        if self._pool is None:
            return
        pool, self._pool = self._pool, None
        for process in list((pool._processes or {}).values()):  # noqa: SLF001 (there is no public way)
            with suppress(ProcessLookupError):
                os.kill(process.pid or 0, signal.SIGTERM)
        pool.shutdown(wait=True, cancel_futures=True)
