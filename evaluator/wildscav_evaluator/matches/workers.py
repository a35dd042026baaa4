"""Worker processes: each plays one match at a time, and none takes another one down.

They are spawned, never forked: a fork after a kernel ran would copy the state of threads that it does not
copy. (The standard library's pool gives all work up when one of its processes dies; ours has another worker
play that one match again.)
"""

import asyncio
import contextlib
import multiprocessing
import os
import signal
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import cast

from wildscav.server.hosting.precompile import precompile_for
from wildscav.system import leftovers
from wildscav.system.worker_processes import become_worker, starting_workers
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent, JobResult, Wanted
from wildscav_evaluator.matches.run_job import after_worker_death, run_job
from wildscav_evaluator.matches.watchdog import CHECK_INTERVAL, Patience, Watchdog
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox.base import signal_name

STOP_TIME = 10.0  # s for a worker to end its match when the evaluation is interrupted
COMPILE_TIME = 3600.0  # s to compile the engine, which takes two minutes
REPLAYS_PER_WORKER = 40  # Rerun keeps some idle threads of every recording until its process ends


@dataclass(frozen=True)
class Precompiling:
    """The message that asks a worker to compile all that matches need, and its answer when that is done."""

    sensors: tuple[Wanted, ...]


class WorkerDiedError(Exception):
    """A worker ended while it had something to do."""


class Worker:
    """One process, and the job that it is at.

    Args:
        lock: Of the folder that it writes to.
        patience: With its jobs.
    """

    def __init__(self, lock: Lock | None, patience: Patience) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        arguments = (theirs, os.getpid(), lock)
        self.process: BaseProcess = context.Process(target=_work, args=arguments, daemon=True)
        with starting_workers():
            self.process.start()
        theirs.close()
        self.job: Job | None = None
        self._watchdog: Watchdog | None = None
        self._patience = patience
        self.dead = False
        self.rendered = 0  # replays

    def give(self, job: Job) -> None:
        """Set it to a job. If it is gone already, ``take`` will say so."""
        self.job, self._watchdog = job, Watchdog(job, self._patience)
        with contextlib.suppress(OSError):
            self.connection.send(job)

    def wait(self, seconds: float) -> bool:
        """Note that a while has gone by, and return whether it hangs."""
        watchdog = cast(Watchdog, self._watchdog)
        watchdog.wait(seconds)
        return bool(watchdog.verdict)

    def take(self) -> JobEvent | Job | JobResult:
        """Return what is waiting: how its job goes on, or its result; if it died or hangs, what follows."""
        job, watchdog = cast(Job, self.job), cast(Watchdog, self._watchdog)
        try:
            event = cast(JobEvent | JobResult, self.connection.recv()) if self.connection.poll() else None
        except (EOFError, OSError):
            self.end(STOP_TIME)
            return after_worker_death(job, f"the worker process died ({self._how_it_ended()})")
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
        return event

    def _how_it_ended(self) -> str:
        code = self.process.exitcode or 0
        return signal_name(-code) if code < 0 else f"exit code {code}"

    def end(self, grace: float = 0.0) -> None:
        """Kill it if it is still there, and remove what it may have left behind.

        Args:
            grace: s that it has to end by itself.
        """
        self.dead = True
        self.connection.close()
        self.process.join(grace)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(STOP_TIME)  # even a kill must wait for a disk that hangs; we need not
        leftovers.sweep()


class Workers:
    """A few workers that share the jobs. A context manager: at its end, all are gone.

    Args:
        count: How many.
        lock: Of the folder that they write to; each holds it as long as it lives.
        patience: With jobs that get no further.
    """

    def __init__(self, count: int, lock: Lock | None = None, patience: Patience | None = None) -> None:
        self._count, self._lock, self._patience = count, lock, patience or Patience()
        self._workers: list[Worker] = []

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, *_: object) -> None:
        """End all workers, and with them their agents."""
        for worker in self._workers:
            worker.connection.close()
            worker.process.terminate()
        until = time.monotonic() + STOP_TIME
        for worker in self._workers:
            worker.end(max(0.0, until - time.monotonic()))

    def precompile(self, sensors: Iterable[Wanted] = ()) -> None:
        """Compile the engine once, in the first worker, so that the others find it done.

        Args:
            sensors: What will be read in matches, for each submission.

        Raises:
            WorkerDiedError: It could not be compiled.
        """
        worker = self._start()
        try:
            worker.connection.send(Precompiling(tuple(sensors)))
            if not worker.connection.poll(COMPILE_TIME):
                raise WorkerDiedError(f"the engine was not compiled within {COMPILE_TIME / 60:g} minutes")
            worker.connection.recv()
        except (EOFError, OSError) as error:
            worker.process.join()
            raise WorkerDiedError(
                f"the engine could not be compiled (exit code {worker.process.exitcode})"
            ) from error

    def run(
        self,
        jobs: Iterable[Job],
        on_start: Callable[[Job], None] = lambda _: None,
        on_event: Callable[[Job, JobEvent], None] = lambda _job, _told: None,
    ) -> Iterator[JobResult]:
        """Run all jobs and yield their results as they come.

        If a worker dies or hangs, another one plays its match from the start, up to ``TRIES`` in all.

        Args:
            jobs: What to play, in this order.
            on_start: Told of every job as it is begun, or begun again.
            on_event: Told now and then how far a match is, and what broke one that is played again.
        """
        waiting = deque(jobs)
        while len(self._workers) < min(self._count, len(waiting)):
            self._start()
        busy: dict[Connection, Worker] = {}
        for worker in self._workers:
            _next_job(worker, waiting, busy, on_start)
        while busy:
            for worker in _heard_of(busy):
                event = worker.take()
                if not isinstance(event, Job | JobResult):
                    on_event(cast(Job, worker.job), event)
                    continue
                del busy[worker.connection]
                if isinstance(event, Job):
                    on_event(event, AttemptFailed(event.faults[-1]))
                    waiting.appendleft(event)
                _next_job(self._fit(worker), waiting, busy, on_start)
                if isinstance(event, JobResult):
                    yield event

    def _fit(self, worker: Worker) -> Worker:
        """Return a worker, or a new one in its place if it can do no more."""
        if not worker.dead and worker.rendered < REPLAYS_PER_WORKER:
            return worker
        self._workers.remove(worker)
        worker.end(STOP_TIME)
        return self._start()

    def _start(self) -> Worker:
        worker = Worker(self._lock, self._patience)
        self._workers.append(worker)
        return worker


def _heard_of(busy: dict[Connection, Worker]) -> list[Worker]:
    """Wait a moment; return the workers that have something to say, have ended or hang."""
    before = time.monotonic()
    speaking = wait(list(busy), CHECK_INTERVAL)
    waited = time.monotonic() - before
    hanging = [worker for worker in busy.values() if worker.wait(waited)]
    return [worker for connection, worker in busy.items() if connection in speaking or worker in hanging]


def _next_job(
    worker: Worker, waiting: deque[Job], busy: dict[Connection, Worker], on_start: Callable[[Job], None]
) -> None:
    if waiting:
        job = waiting.popleft()
        on_start(job)
        worker.give(job)
        busy[worker.connection] = worker


def _work(connection: Connection, parent: int, _lock: Lock | None) -> None:
    """Do what is asked until nobody asks any more. Runs in the worker's process.

    Args:
        connection: Where jobs come from and results go.
        parent: The process that started this one.
        _lock: Is held until this process ends, however it ends.
    """
    become_worker(parent)
    with asyncio.Runner() as runner, contextlib.suppress(EOFError, OSError):
        while True:
            message = connection.recv()
            if isinstance(message, Precompiling):
                precompile_for(message.sensors)
                connection.send(message)
            else:
                # Only a match has agents to be stopped; elsewhere a worker may end on the spot.
                signal.signal(signal.SIGTERM, _leave)
                try:
                    result = run_job(runner, message, partial(_send_event, connection))
                except asyncio.CancelledError:
                    raise SystemExit(128 + signal.SIGTERM) from None
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                connection.send(result)


def _send_event(connection: Connection, event: JobEvent) -> None:
    # Nobody listens any more: the result will not be taken either, and that ends this process.
    with contextlib.suppress(OSError):
        connection.send(event)


def _leave(number: int, _: object) -> None:
    # Leaves through every `finally` on the way, which is where agents are stopped.
    raise SystemExit(128 + number)
