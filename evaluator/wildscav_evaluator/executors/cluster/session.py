"""What the bridge's process does for each request."""

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

import ray
from ray.exceptions import RayError, RayTaskError

from wildscav_evaluator.executors.base import ExecutorError
from wildscav_evaluator.executors.cluster.cluster_nodes import ClusterNode, ClusterNodes, last_line
from wildscav_evaluator.executors.cluster.match_host import Shipment
from wildscav_evaluator.executors.cluster.match_schedule import MatchSchedule
from wildscav_evaluator.executors.cluster.messages import (
    Call,
    Examine,
    Message,
    NextItem,
    Nodes,
    Play,
    Prepare,
    Request,
    Returned,
    Use,
)
from wildscav_evaluator.executors.cluster.submission_archives import pack
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.submissions.submission import folder_digest

QUEUED = 2  # calls, at most, that a node has at once for each of its cores
ATTEMPTS = 3  # at each call, if its process or its node is lost
TICK = 1.0  # s


class ClusterSession:
    """The use of a cluster that this process is connected to."""

    def __init__(self) -> None:
        self._nodes = ClusterNodes()
        self._schedule: MatchSchedule | None = None

    def carry_out(self, request: Request) -> Generator[Message, Any, None]:
        """Carry out a request, and yield the messages that answer it."""
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
    """Put each submission's files into the cluster's object store; refuse changed and too large ones."""
    shipments: dict[Path, Shipment] = {}
    for one in {one.folder: one for job in jobs for one in job.submissions}.values():
        digest = folder_digest(one.folder)
        if one.image is None and digest != one.digest:
            raise ExecutorError(f"{one.folder} was changed since this command began")
        shipments[one.folder] = Shipment(digest, ray.put(pack(one.folder)))
    return shipments


class Called(NamedTuple):
    """A call that was sent to a node."""

    number: int  # of the item
    item: Any  # a reference to it
    node: ClusterNode
    attempts: int  # with this one


class Calls:
    """Calls a function of a module with items, each on one core of a node."""

    def __init__(self, nodes: ClusterNodes, function: Callable[[Any], Any], at_once: int) -> None:
        self._nodes = nodes
        self._remote = ray.remote(num_cpus=1, max_retries=0)(function)
        self._most = at_once
        self._called: dict[Any, Called] = {}  # by the reference to the value

    def run(self) -> Generator[Message, Any, None]:
        """Ask for items, and yield values as they come; ExecutorError if a call fails or no node is left."""
        number, more = 0, True
        while more or self._called:
            while more and (node := self._free_node()) is not None:
                item = yield NextItem()
                if not item:
                    more = False
                    break
                self._call(Called(number, ray.put(item[0]), node, 1))
                number += 1
            yield from self._values()

    def _free_node(self) -> ClusterNode | None:
        """Return the node with the fewest calls for its cores; None if all have enough."""
        self._nodes.look()
        if len(self._called) >= self._most:
            return None
        if not self._nodes.used:
            raise ExecutorError("no node of the Ray cluster is left")
        node = min(self._nodes.used, key=lambda node: node.running / node.cores)
        return node if node.running < QUEUED * node.cores else None

    def _call(self, call: Called) -> None:
        value = self._remote.options(scheduling_strategy=call.node.strategy).remote(call.item)
        call.node.running += 1
        self._called[value] = call

    def _values(self) -> Generator[Message, Any, None]:
        if not self._called:
            return
        ready, _ = ray.wait(list(self._called), num_returns=1, timeout=TICK)
        for reference in ready:
            call = self._called.pop(reference)
            call.node.running -= 1
            try:
                value = ray.get(reference)
            except RayTaskError as error:
                raise ExecutorError(f"a call failed on {call.node.name}: {last_line(error)}") from error
            except RayError as error:
                self._again(call, last_line(error))
                continue
            call.node.done += 1
            yield Returned(call.number, value)

    def _again(self, call: Called, reason: str) -> None:
        call.node.note_failure(reason)
        others = [node for node in self._nodes.used if node is not call.node] or self._nodes.used
        if call.attempts >= ATTEMPTS or not others:
            raise ExecutorError(f"a call failed on {call.node.name}: {reason}")
        node = min(others, key=lambda node: node.running / node.cores)
        self._call(call._replace(node=node, attempts=call.attempts + 1))

    def close(self) -> None:
        """Cancel what is still running."""
        for reference in self._called:
            ray.cancel(reference, force=True)
