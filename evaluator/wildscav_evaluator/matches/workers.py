"""Worker processes: each plays one match at a time, and none takes another one down.

They are spawned, never forked: a fork after a kernel ran would copy the state of threads that it does not
copy. (The standard library's pool gives all work up when one of its processes dies; ours gives up one job.)
"""

import asyncio
import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import cast

from wildscav_evaluator.matches.jobs import Beat, Job, JobResult, failed, run_job
from wildscav_evaluator.matches.warm import Wanted, warm
from wildscav_evaluator.output.lock import Lock

STOP_TIME = 10.0  # s for a worker to end its match when the evaluation is broken off
PR_SET_PDEATHSIG = 1
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

    def take(self) -> Beat | JobResult:
        """Return what is waiting: how far its match is, or the result; if it died, the failure of its job."""
        job = cast(Job, self.job)
        try:
            result = cast(Beat | JobResult, self.connection.recv())
        except (EOFError, OSError):
            self.dead = True
            self.process.join()
            return failed(job, f"the worker process died (exit code {self.process.exitcode})")
        if isinstance(result, JobResult):
            self.rendered += result.row.replay is not None
        return result

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
        beat: Callable[[Job, Beat], None] = lambda _job, _beat: None,
    ) -> Iterator[JobResult]:
        """Run all jobs and yield their results as they come. One worker's death costs its job alone.

        Args:
            jobs: What to play, in this order.
            started: Told of every job as it is begun.
            beat: Told now and then how far a match is.
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
                result = worker.take()
                if isinstance(result, Beat):
                    beat(cast(Job, worker.job), result)
                    continue
                del busy[worker.connection]
                if worker.dead or worker.rendered >= REPLAYS_PER_WORKER:
                    worker = self._replace(worker)
                _next_job(worker, waiting, busy, started)
                yield result

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
                result = run_job(runner, message, partial(_send_beat, connection))
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                connection.send(result)


def _send_beat(connection: Connection, beat: Beat) -> None:
    # Nobody listens any more: the result will not be taken either, and that ends this process.
    with contextlib.suppress(OSError):
        connection.send(beat)


def _leave(number: int, _: object) -> None:
    # Leaves through every `finally` on the way, which is where agents are stopped.
    raise SystemExit(128 + number)


def end_with_parent(parent: int) -> None:
    """Have Linux end this process in good order when its parent is gone, however that came about.

    Args:
        parent: The process that started this one.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != parent:  # it was gone before Linux was told
            raise SystemExit(128 + signal.SIGTERM)
