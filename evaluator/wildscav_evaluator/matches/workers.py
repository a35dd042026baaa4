"""Worker processes: each plays one match at a time, and the death of one does not affect the others.

The standard library's pool abandons all work when one of its processes dies; here another worker plays that
one match again.
"""

import asyncio
import contextlib
import signal
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import cast

from wildscav.system.worker_pool import start_worker
from wildscav.system.worker_processes import become_worker
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent, JobResult, RenderingReplay, Wanted
from wildscav_evaluator.matches.run_job import after_worker_death, run_job
from wildscav_evaluator.matches.watchdog import CHECK_INTERVAL, ProgressTimeouts, Watchdog
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox.base import signal_name
from wildscav_server import leftovers
from wildscav_server.hosting.precompile import precompile_for

STOP_TIME = 10.0  # s for a worker to stop its match when the evaluation is interrupted
COMPILE_TIME = 3600.0  # s, at most, to compile the engine; it usually takes two minutes
REPLAYS_PER_WORKER = 40  # each Rerun recording leaves some idle threads until its process ends


@dataclass(frozen=True)
class Precompiling:
    """The message that asks a worker to compile all that matches need, and its answer when that is done."""

    sensors: tuple[Wanted, ...]


class WorkerDiedError(Exception):
    """A worker died while it was compiling the engine."""


class Worker:
    """A worker process, which holds the lock of the folder that it writes to, and the job that it runs."""

    def __init__(self, lock: Lock | None, timeouts: ProgressTimeouts) -> None:
        self.process, self.connection = start_worker(_work, lock)
        self.job: Job | None = None
        self._watchdog: Watchdog | None = None
        self._timeouts = timeouts
        self.dead = False
        self.rendered = 0  # replays so far

    def precompile(self, sensors: Iterable[Wanted]) -> None:
        """Compile the engine in that process, or load it from the cache; WorkerDiedError if that fails."""
        try:
            self.connection.send(Precompiling(tuple(sensors)))
            if not self.connection.poll(COMPILE_TIME):
                raise WorkerDiedError(f"the engine was not compiled within {COMPILE_TIME / 60:g} minutes")
            self.connection.recv()
        except (EOFError, OSError) as error:
            self.process.join()
            raise WorkerDiedError(
                f"the engine could not be compiled (exit code {self.process.exitcode})"
            ) from error

    def assign(self, job: Job) -> None:
        """Send it a job. If the process is gone already, ``receive`` will report that."""
        self.job, self._watchdog = job, Watchdog(job, self._timeouts)
        with contextlib.suppress(OSError):
            self.connection.send(job)

    def wait(self, seconds: float) -> bool:
        """Note that some time has passed, and return whether the worker hangs."""
        watchdog = cast(Watchdog, self._watchdog)
        watchdog.wait(seconds)
        return bool(watchdog.verdict)

    def receive(self) -> JobEvent | Job | JobResult:
        """Return the next event or result; after a death or hang, the job to run again or its result."""
        job, watchdog = cast(Job, self.job), cast(Watchdog, self._watchdog)
        try:
            event = cast(JobEvent | JobResult, self.connection.recv()) if self.connection.poll() else None
        except (EOFError, OSError):
            self.end(STOP_TIME)
            code = self.process.exitcode or 0
            how = signal_name(-code) if code < 0 else f"exit code {code}"
            return after_worker_death(job, f"the worker process died ({how})")
        if isinstance(event, JobResult):
            self.rendered += event.row.replay is not None
            return event
        if event is not None:
            watchdog.hear(event)
        if event is None or watchdog.verdict:
            self.end()
            return after_worker_death(job, watchdog.verdict)
        if isinstance(event, AttemptFailed):
            self.job = replace(job, faults=(*job.faults, event.reason))
        elif isinstance(event, RenderingReplay):
            self.job = replace(job, kept=event.kept)
        return event

    def end(self, grace: float = 0.0) -> None:
        """Kill the process if it still runs after some grace, s, and remove what it may have left behind."""
        self.dead = True
        self.connection.close()
        self.process.join(grace)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(STOP_TIME)  # a process that waits for a hanging disk cannot be killed at once
        leftovers.sweep()


class Workers:
    """A group of workers that share the jobs, as a context manager that stops all of them when it exits.

    Each worker holds the lock of the folder that they write to as long as it lives.
    """

    def __init__(
        self, count: int, lock: Lock | None = None, timeouts: ProgressTimeouts | None = None
    ) -> None:
        self._count, self._lock, self._timeouts = count, lock, timeouts or ProgressTimeouts()
        self._workers: list[Worker] = []

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, *_: object) -> None:
        """Stop all workers, and thereby their agents."""
        for worker in self._workers:
            worker.connection.close()
            worker.process.terminate()
        until = time.monotonic() + STOP_TIME
        for worker in self._workers:
            worker.end(max(0.0, until - time.monotonic()))

    def precompile(self, sensors: Iterable[Wanted] = ()) -> None:
        """Compile the engine once, in the first worker, so that the others load it from the cache."""
        self._start().precompile(sensors)

    def run(
        self,
        jobs: Iterable[Job],
        on_start: Callable[[Job], bool | None] = lambda _: None,
        on_event: Callable[[Job, JobEvent], None] = lambda _job, _event: None,
    ) -> Iterator[JobResult]:
        """Run all jobs and yield their results as they arrive. See ``Players.run``."""
        waiting = deque(jobs)
        while len(self._workers) < min(self._count, len(waiting)):
            self._start()
        busy: dict[Connection, Worker] = {}
        for worker in self._workers:
            _next_job(worker, waiting, busy, on_start)
        while busy:
            for worker in _wait_for_workers(busy):
                event = worker.receive()
                if not isinstance(event, Job | JobResult):
                    on_event(cast(Job, worker.job), event)
                    continue
                del busy[worker.connection]
                if isinstance(event, Job):
                    on_event(event, AttemptFailed(event.faults[-1]))
                    waiting.appendleft(event)
                _next_job(self._replace_if_spent(worker), waiting, busy, on_start)
                if isinstance(event, JobResult):
                    yield event

    def _replace_if_spent(self, worker: Worker) -> Worker:
        """Return a worker, or a new one in its place if it is dead or has rendered enough replays."""
        if not worker.dead and worker.rendered < REPLAYS_PER_WORKER:
            return worker
        self._workers.remove(worker)
        worker.end(STOP_TIME)
        return self._start()

    def _start(self) -> Worker:
        worker = Worker(self._lock, self._timeouts)
        self._workers.append(worker)
        return worker


def _wait_for_workers(busy: dict[Connection, Worker]) -> list[Worker]:
    """Wait for a short time; return the workers that sent something, have ended or hang."""
    before = time.monotonic()
    ready = wait(list(busy), CHECK_INTERVAL)
    waited = time.monotonic() - before
    hanging = [worker for worker in busy.values() if worker.wait(waited)]
    return [worker for connection, worker in busy.items() if connection in ready or worker in hanging]


def _next_job(
    worker: Worker,
    waiting: deque[Job],
    busy: dict[Connection, Worker],
    on_start: Callable[[Job], bool | None],
) -> None:
    while waiting and worker.connection not in busy:
        job = waiting.popleft()
        if on_start(job) is not False:
            worker.assign(job)
            busy[worker.connection] = worker


def _work(connection: Connection, parent: int, _lock: Lock | None) -> None:
    """Handle messages until the connection is closed. Runs in the worker's process.

    The process holds the folder's lock until it ends in any way.
    """
    become_worker(parent)
    with asyncio.Runner() as runner, contextlib.suppress(EOFError, OSError):
        while True:
            message = connection.recv()
            if isinstance(message, Precompiling):
                precompile_for(message.sensors)
                connection.send(message)
            else:
                # Only a match has agents to stop; at any other time a worker may end at once.
                signal.signal(signal.SIGTERM, _leave)
                try:
                    result = run_job(runner, message, partial(_send_event, connection))
                except asyncio.CancelledError:
                    raise SystemExit(128 + signal.SIGTERM) from None
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                connection.send(result)


def _send_event(connection: Connection, event: JobEvent) -> None:
    # If the other end is closed, sending the result will fail too, and that ends this process.
    with contextlib.suppress(OSError):
        connection.send(event)


def _leave(number: int, _: object) -> None:
    # Runs every `finally` block on the way out; those stop the agents.
    raise SystemExit(128 + number)
