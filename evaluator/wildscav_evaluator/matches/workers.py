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
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import cast

from wildscav.processes import end_with_parent
from wildscav_evaluator.matches.jobs import Beat, Broken, Job, JobResult, Told, after_death, run_job
from wildscav_evaluator.matches.play import remove_sockets
from wildscav_evaluator.matches.warm import Wanted, warm
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox.base import signal_name

STOP_TIME = 10.0  # s for a worker to end its match when the evaluation is broken off
REPLAYS_PER_WORKER = 40  # Rerun keeps some idle threads of every recording until its process ends


@dataclass(frozen=True)
class Warming:
    """The message that asks a worker to compile all that matches need, and its answer when that is done."""

    sensors: tuple[Wanted, ...]


class WorkerDiedError(Exception):
    """A worker ended while it had something to do."""


class Worker:
    """One process, and the job that it is at."""

    def __init__(self, lock: Lock | None) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        arguments = (theirs, os.getpid(), lock)
        self.process: BaseProcess = context.Process(target=_work, args=arguments, daemon=True)
        self.process.start()
        theirs.close()
        self.job: Job | None = None
        self.dead = False
        self.rendered = 0  # replays

    def give(self, job: Job) -> None:
        """Set it to a job. If it is gone already, ``take`` will say so."""
        self.job = job
        with contextlib.suppress(OSError):
            self.connection.send(job)

    def take(self) -> Told | Job | JobResult:
        """Return what is waiting: how its match goes on, or its result; if it died, what its job comes to."""
        job = cast(Job, self.job)
        try:
            told = cast(Told | JobResult, self.connection.recv())
        except (EOFError, OSError):
            self.dead = True
            return after_death(job, f"the worker process died ({self._clear_away()})")
        if isinstance(told, JobResult):
            self.rendered += told.row.replay is not None
        elif isinstance(told, Broken):
            self.job = replace(job, faults=(*job.faults, told.reason))
        return told

    def _clear_away(self) -> str:
        """Remove what it left behind, being dead, and return how it ended."""
        self.process.join()
        if self.process.pid is not None:
            remove_sockets(self.process.pid)
        code = self.process.exitcode or 0
        return signal_name(-code) if code < 0 else f"exit code {code}"

    def close(self) -> None:
        """Let it go while it has nothing to do."""
        self.connection.close()
        self.process.join(STOP_TIME)


class Workers:
    """A few workers that share the jobs. A context manager: at its end, all are gone.

    Args:
        count: How many.
        lock: Of the folder that they write to; each holds it as long as it lives.
    """

    def __init__(self, count: int, lock: Lock | None = None) -> None:
        self._count, self._lock = count, lock
        self._workers: list[Worker] = []

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, *_: object) -> None:
        """End all workers, and with them their agents."""
        for worker in self._workers:
            worker.connection.close()
            worker.process.terminate()
        for worker in self._workers:
            worker.process.join(STOP_TIME)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()

    def warm(self, sensors: Iterable[Wanted] = ()) -> None:
        """Compile the engine once, in the first worker, so that the others find it done.

        Args:
            sensors: What will be read in matches, for each submission.

        Raises:
            WorkerDiedError: It could not be compiled.
        """
        worker = self._start()
        try:
            worker.connection.send(Warming(tuple(sensors)))
            worker.connection.recv()
        except (EOFError, OSError) as error:
            worker.process.join()
            raise WorkerDiedError(
                f"the engine could not be compiled (exit code {worker.process.exitcode})"
            ) from error

    def run(
        self,
        jobs: Iterable[Job],
        started: Callable[[Job], None] = lambda _: None,
        tell: Callable[[Job, Told], None] = lambda _job, _told: None,
    ) -> Iterator[JobResult]:
        """Run all jobs and yield their results as they come.

        If a worker dies, another one plays its match from the start, up to ``TRIES`` in all.

        Args:
            jobs: What to play, in this order.
            started: Told of every job as it is begun, or begun again.
            tell: Told now and then how far a match is, and what broke one that is played again.
        """
        waiting = deque(jobs)
        while len(self._workers) < min(self._count, len(waiting)):
            self._start()
        busy: dict[Connection, Worker] = {}
        for worker in self._workers:
            _next_job(worker, waiting, busy, started)
        while busy:
            for connection in wait(list(busy)):
                worker = busy[cast(Connection, connection)]
                told = worker.take()
                if isinstance(told, Beat | Broken):
                    tell(cast(Job, worker.job), told)
                    continue
                del busy[worker.connection]
                if isinstance(told, Job):
                    tell(told, Broken(told.faults[-1]))
                    waiting.appendleft(told)
                if worker.dead or worker.rendered >= REPLAYS_PER_WORKER:
                    worker = self._replace(worker)
                _next_job(worker, waiting, busy, started)
                if isinstance(told, JobResult):
                    yield told

    def _replace(self, worker: Worker) -> Worker:
        self._workers.remove(worker)
        worker.close()
        return self._start()

    def _start(self) -> Worker:
        worker = Worker(self._lock)
        self._workers.append(worker)
        return worker


def _next_job(
    worker: Worker, waiting: deque[Job], busy: dict[Connection, Worker], started: Callable[[Job], None]
) -> None:
    if waiting:
        job = waiting.popleft()
        started(job)
        worker.give(job)
        busy[worker.connection] = worker


def _work(connection: Connection, parent: int, _lock: Lock | None) -> None:
    """Do what is asked until nobody asks any more. Runs in the worker's process.

    Args:
        connection: Where jobs come from and results go.
        parent: The process that started this one.
        _lock: Is held until this process ends, however it ends.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the evaluation, which then ends us
    end_with_parent(parent)
    with asyncio.Runner() as runner, contextlib.suppress(EOFError, OSError):
        while True:
            message = connection.recv()
            if isinstance(message, Warming):
                warm(message.sensors)
                connection.send(message)
            else:
                # Only a match has agents to be stopped; elsewhere a worker may end on the spot.
                signal.signal(signal.SIGTERM, _leave)
                try:
                    result = run_job(runner, message, partial(_tell, connection))
                except asyncio.CancelledError:
                    raise SystemExit(128 + signal.SIGTERM) from None
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                connection.send(result)


def _tell(connection: Connection, told: Told) -> None:
    # Nobody listens any more: the result will not be taken either, and that ends this process.
    with contextlib.suppress(OSError):
        connection.send(told)


def _leave(number: int, _: object) -> None:
    # Leaves through every `finally` on the way, which is where agents are stopped.
    raise SystemExit(128 + number)
