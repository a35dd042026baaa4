"""Starting workers: processes that are spawned, alone or in a pool.

They are never forked: a fork after a kernel ran would copy the state of threads but not the threads
themselves.
"""

import os
import signal
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Any

from wildscav.system.worker_processes import become_worker, starting_workers


def start_worker(work: Callable[..., None], *arguments: Any) -> tuple[BaseProcess, Connection]:
    """Start a worker, and return it with this end of a connection to it.

    Args:
        work: What it does. It is called with the other end, the id of this process, and the arguments, and is
            to call ``become_worker`` first.
    """
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process: BaseProcess = context.Process(target=work, args=(theirs, os.getpid(), *arguments), daemon=True)
    with starting_workers():
        process.start()
    theirs.close()
    return process, ours


class WorkerPool(ProcessPoolExecutor):
    """A pool of so many workers. At the end of its block it waits for them, or kills them after an error."""

    def __init__(self, count: int) -> None:
        super().__init__(count, get_context("spawn"), become_worker, (os.getpid(),))

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """Call a function in a worker; workers are started as they are needed."""
        with starting_workers():
            return super().submit(function, *arguments, **named)

    def kill(self) -> None:
        """End the workers, whatever they are doing, and drop what waits."""
        for process in list((self._processes or {}).values()):
            with suppress(ProcessLookupError):
                os.kill(process.pid or 0, signal.SIGTERM)
        self.shutdown(wait=True, cancel_futures=True)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait for the workers, or kill them: after an error nobody needs what they are doing."""
        if error is not None:
            self.kill()
        self.shutdown()
