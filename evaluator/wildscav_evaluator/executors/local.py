"""The executor of this machine: worker processes."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Self

from wildscav.errors import UserError
from wildscav.system.worker_pool import WorkerPool
from wildscav_engine.parallel.threads import cores
from wildscav_evaluator.executors.base import Examined, ExecutorError, Item, Node, Value
from wildscav_evaluator.matches.jobs import Job, sensors_read
from wildscav_evaluator.matches.workers import WorkerDiedError, Workers
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES
from wildscav_evaluator.sandbox.choose import Choice, choose
from wildscav_evaluator.submissions.images import with_images
from wildscav_evaluator.submissions.submission import Submission

QUEUED = 4  # items, at most, that wait in the pool for each process


class LocalExecutor:
    """Plays matches and calls functions in processes on this machine. See ``Executor``."""

    name = "local"

    def __init__(self, at_once: int | None = None, address: str | None = None) -> None:
        if address is not None:
            raise UserError(
                "--address names a cluster, and --executor local has none: use --executor ray", exit_code=2
            )
        self._at_once = at_once or cores()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Do nothing: what was started is stopped at the end of ``players`` and ``map``."""

    @property
    def at_once(self) -> int:
        """How many matches or calls at once, at most."""
        return self._at_once

    @property
    def nodes(self) -> tuple[Node, ...]:
        """None: this machine is no cluster."""
        return ()

    def examine(self, sandboxes: Sequence[str]) -> tuple[Examined, ...]:  # noqa: ARG002
        """Return nothing: this machine is no cluster."""
        return ()

    def choose_sandbox(
        self, asked: str | None, submissions: Sequence[Submission]
    ) -> tuple[Choice, tuple[Submission, ...]]:
        """Try sandboxes on this machine. See ``Executor``."""
        images = any(submission.image for submission in submissions)
        candidates = [SANDBOXES[name] for name in ([asked] if asked else SANDBOXES.built_in)]
        choice = choose(asked, candidates, DEFAULT_LIMITS, images=images)
        return choice, with_images(submissions, choice.sandbox.name)

    @contextmanager
    def players(self, jobs: Sequence[Job], lock: Lock | None = None) -> Iterator[Workers]:
        """Start workers, and compile the engine in the first one. See ``Executor``."""
        with Workers(min(self._at_once, len(jobs)), lock) as workers:
            try:
                workers.precompile(sensors_read(jobs))
            except WorkerDiedError as error:
                raise ExecutorError(str(error)) from error
            yield workers

    def map(self, function: Callable[[Item], Value], items: Iterable[Item]) -> Iterator[Value]:
        """Call a function in a pool of processes; in this process if only one is wanted. See ``Executor``."""
        if self._at_once == 1:
            yield from map(function, items)
            return
        try:
            with WorkerPool(self._at_once) as pool:
                yield from _in_order(pool, function, items, self._at_once * QUEUED)
        except BrokenProcessPool as error:
            raise ExecutorError("a worker process died: the machine may have no memory left") from error


def _in_order(
    pool: WorkerPool, function: Callable[[Item], Value], items: Iterable[Item], queued: int
) -> Iterator[Value]:
    """Yield the values of a function in the order of the items, of which only some are taken ahead."""
    pending: deque[Future[Value]] = deque()
    alone = True
    for item in items:
        pending.append(pool.submit(function, item))
        # The first alone, so that the others find the compiled code in the cache.
        if alone or len(pending) >= queued:
            yield pending.popleft().result()
            alone = False
    while pending:
        yield pending.popleft().result()
