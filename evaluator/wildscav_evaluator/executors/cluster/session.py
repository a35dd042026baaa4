"""What the bridge's process does for each request."""

from collections.abc import Generator, Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

import ray

from wildscav_evaluator.executors.base import ExecutorError
from wildscav_evaluator.executors.cluster.calls import Calls
from wildscav_evaluator.executors.cluster.cluster_nodes import ClusterNodes
from wildscav_evaluator.executors.cluster.match_host import Shipment
from wildscav_evaluator.executors.cluster.match_schedule import MatchSchedule
from wildscav_evaluator.executors.cluster.messages import (
    Call,
    Examine,
    Message,
    Nodes,
    Play,
    Prepare,
    Request,
    Use,
)
from wildscav_evaluator.executors.cluster.submission_archives import pack
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.submissions.submission import folder_digest


class ClusterSession:
    """The use of a cluster that this process is connected to."""

    def __init__(self) -> None:
        self._nodes = ClusterNodes()
        self._schedule: MatchSchedule | None = None

    def carry_out(self, request: Request) -> Generator[Message, Any, None]:
        """Carry out a request, and yield the messages that answer it.

        Raises:
            ExecutorError: It cannot be carried out.
        """
        match request:
            case Examine():
                yield self._nodes.examine(request)
            case Use(sandbox):
                self._nodes.use(sandbox)
                yield Nodes(self._nodes.shown)
            case Prepare(jobs, at_once):
                self._schedule = MatchSchedule(self._nodes, jobs, at_once, shipments_of(jobs))
                self._schedule.prepare()
            case Play():
                yield from self._play()
            case Call(function, at_once):
                with closing(Calls(self._nodes, function, at_once)) as calls:
                    yield from calls.run()

    def _play(self) -> Generator[Message, Any, None]:
        if self._schedule is None:
            raise RuntimeError("no matches were prepared")
        try:
            yield from self._schedule.run()
        finally:
            self._schedule.close()
            self._schedule = None

    def close(self) -> None:
        """Stop everything that runs on the cluster, and disconnect."""
        if self._schedule is not None:
            self._schedule.close()
        ray.shutdown()


def shipments_of(jobs: Iterable[Job]) -> dict[Path, Shipment]:
    """Put the files of all submissions of some jobs into the cluster's object store, each once.

    Raises:
        ExecutorError: A submission was changed since it was loaded.
        UserError: One is too large.
    """
    shipments: dict[Path, Shipment] = {}
    for one in {one.folder: one for job in jobs for one in job.submissions}.values():
        digest = folder_digest(one.folder)
        if one.image is None and digest != one.digest:
            raise ExecutorError(f"{one.folder} was changed since this command began")
        shipments[one.folder] = Shipment(digest, ray.put(pack(one.folder)))
    return shipments
