"""The actor that plays matches on a node, one at a time, in a worker process like those of this machine.

A match is played in a temporary folder of the node. Its files come back as bytes.
"""

import contextlib
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from wildscav.errors import UserError, describe
from wildscav_evaluator.executors.cluster.messages import Played
from wildscav_evaluator.executors.cluster.submission_archives import arrived
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent, JobResult, RenderingReplay, Wanted
from wildscav_evaluator.matches.watchdog import CHECK_INTERVAL, ProgressTimeouts
from wildscav_evaluator.matches.workers import (
    REPLAYS_PER_WORKER,
    STOP_TIME,
    Worker,
    WorkerDiedError,
)
from wildscav_evaluator.output.layout import EXCHANGES, LOGS, RECORDS, REPLAYS
from wildscav_evaluator.submissions.images import with_images
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers

REPORT_INTERVAL = 2.0  # s, at most, between two reports on a match
RETURNED = (RECORDS, REPLAYS, LOGS, EXCHANGES)  # the folders whose files come back
# Variables that Ray sets for its own processes; agents without a sandbox would see their effects.
RAYS_OWN = ("OMP_NUM_THREADS", "CUDA_VISIBLE_DEVICES")


@dataclass(frozen=True)
class Shipment:
    """A submission's files in the cluster's object store."""

    digest: str  # of the folder
    archive: Any  # a reference to the archive


@dataclass(frozen=True)
class Broken:
    """The platform broke an attempt outside of the match itself."""

    reason: str  # in one line


@dataclass(frozen=True)
class Report:
    """What happened in a match since the last report."""

    events: tuple[JobEvent, ...] = ()
    end: Played | Broken | None = None  # None while it goes on


class MatchHost:
    """Plays matches on a node, each from ``play`` and ``report`` calls until a report has its end."""

    def __init__(self, sensors: Sequence[Wanted], timeouts: ProgressTimeouts | None = None) -> None:
        for name in RAYS_OWN:
            os.environ.pop(name, None)
        # Otherwise each worker would import Ray's main module, and thereby Ray.
        vars(sys.modules["__main__"]).pop("__file__", None)
        self._sensors, self._timeouts = tuple(sensors), timeouts or ProgressTimeouts()
        self._arrived: dict[str, Path] = {}
        self._stack = contextlib.ExitStack()  # with the folder of the current match
        self._job: Job | None = None  # as it was asked for, with its paths on the other machine
        self._worker: Worker | None = None

    def prepare(self) -> None:
        """Start the worker, and compile the engine or load it; WorkerDiedError if that fails."""
        self._ready_worker()

    def play(self, job: Job, shipments: Mapping[Path, Shipment], files: Mapping[str, bytes]) -> Report:
        """Start a match, and return the first report on it.

        The job has paths of the machine that asks for it, and by these its submissions' ``shipments``.
        ``files`` of an earlier run that it needs are by their paths in the output folder.
        """
        self._job = job
        try:
            folder = self._stack.enter_context(leftovers.temporary_folder("match-"))
            for name in RETURNED:
                (folder / name).mkdir()
            for path, content in files.items():
                (folder / path).write_bytes(content)
            here = replace(job, out=folder, submissions=self._submissions(job, shipments))
            self._ready_worker().assign(here)
        except OSError as error:
            return self._broken(describe(error))
        except (UserError, WorkerDiedError) as error:
            return self._broken(str(error))
        return self.report()

    def _broken(self, reason: str) -> Report:
        self._stack.close()
        return Report(end=Broken(reason))

    def _submissions(self, job: Job, shipments: Mapping[Path, Shipment]) -> tuple[Submission, ...]:
        """Return a job's submissions, as they are here."""
        return tuple(
            with_images([replace(one, folder=self._folder(shipments[one.folder]))], job.sandbox)[0]
            for one in job.submissions
        )

    def _folder(self, shipment: Shipment) -> Path:
        if shipment.digest not in self._arrived:
            import ray

            self._arrived[shipment.digest] = arrived(ray.get(shipment.archive), shipment.digest)
        return self._arrived[shipment.digest]

    def _ready_worker(self) -> Worker:
        worker = self._worker
        if worker is not None and not worker.dead and worker.rendered < REPLAYS_PER_WORKER:
            return worker
        if worker is not None:
            worker.end(STOP_TIME)
        self._worker = Worker(None, self._timeouts)
        self._worker.precompile(self._sensors)
        return self._worker

    def report(self) -> Report:
        """Wait for the match to end, for a short time at most, and return what happened."""
        if self._worker is None or self._job is None:
            raise RuntimeError("no match is being played")
        events: list[JobEvent] = []
        for event in _events(self._worker, REPORT_INTERVAL):
            if isinstance(event, JobResult):
                return Report(tuple(events), self._returned(event))
            if isinstance(event, Job):
                self._stack.close()
                return Report(tuple(events), Broken(event.faults[-1]))
            if events and isinstance(event, Heartbeat) and isinstance(events[-1], Heartbeat):
                events.pop()  # only the last one matters
            # The record comes back with the replay, so nothing is kept of the match before.
            events.append(RenderingReplay() if isinstance(event, RenderingReplay) else event)
            if isinstance(event, Heartbeat) and event.snapshots:
                break  # spectators wait for them
        return Report(tuple(events))

    def _returned(self, result: JobResult) -> Played:
        """Return a result with its files, and remove them here."""
        here, asked = str(result.job.out), str(self._job.out if self._job else "")
        detail = result.row.detail.replace(here, asked)
        try:
            files = {
                path.relative_to(here).as_posix(): path.read_bytes()
                for name in RETURNED
                for path in (result.job.out / name).iterdir()
                if not path.name.startswith(".")
            }
        finally:
            self._stack.close()
        row = result.row.model_copy(update={"detail": detail})
        return Played(row, result.timing, result.replay_error.replace(here, asked), files)

    def stop(self) -> None:
        """Stop the worker, and thereby the agents of its match."""
        if self._worker is not None and not self._worker.dead:
            self._worker.process.terminate()
            self._worker.end(STOP_TIME)
        self._stack.close()


def _events(worker: Worker, seconds: float) -> Iterator[JobEvent | Job | JobResult]:
    """Yield what a worker sends in some time, and what its death or its hanging means."""
    until = time.monotonic() + seconds
    while (left := until - (before := time.monotonic())) > 0.0:
        ready = wait([worker.connection], min(left, CHECK_INTERVAL))
        if worker.wait(time.monotonic() - before) or ready:
            yield worker.receive()
