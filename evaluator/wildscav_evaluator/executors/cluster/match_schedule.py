"""Which match is played on which node, and what happens when a node or one of its processes is lost."""

import time
from collections import Counter, deque
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import ray
from ray.exceptions import RayError

from wildscav_evaluator.executors.base import ExecutorError
from wildscav_evaluator.executors.cluster.cluster_nodes import ClusterNode, ClusterNodes, last_line
from wildscav_evaluator.executors.cluster.match_host import Broken, MatchHost, Report, Shipment
from wildscav_evaluator.executors.cluster.messages import (
    Happened,
    MatchEnded,
    Message,
    Nodes,
    Played,
    Starting,
)
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, cores_of, sensors_read
from wildscav_evaluator.matches.run_job import after_worker_death
from wildscav_evaluator.matches.workers import COMPILE_TIME

TICK = 1.0  # s, at most, between two looks at everything
SILENCE = 120.0  # s in which a process may not answer before it counts as lost
START_TIME = 900.0  # s for its first answer on a match, for which it may have to start a worker
STOP_TIME = 10.0  # s for all matches to be stopped


@dataclass(eq=False)
class Host:
    """A process on a node that plays one match at a time."""

    node: ClusterNode
    cores: int  # that it has reserved
    actor: Any
    answer: Any  # the reference to its next answer; None while it is idle
    is_ready: bool = False
    number: int | None = None  # of the job that it is playing
    silent: float = 0.0  # s without an answer
    timeout: float = COMPILE_TIME  # s in which it may not answer

    @property
    def is_idle(self) -> bool:
        """Whether it waits for a match."""
        return self.is_ready and self.answer is None


class MatchSchedule:
    """Plays jobs on the nodes of a cluster, in their order; submissions are shipped by their folders here."""

    def __init__(
        self, nodes: ClusterNodes, jobs: Sequence[Job], at_once: int, shipments: Mapping[Path, Shipment]
    ) -> None:
        self._nodes, self._at_once, self._shipments = nodes, at_once, shipments
        self._jobs = list(jobs)
        self._waiting = deque(range(len(jobs)))
        self._hosts: list[Host] = []
        self._sensors = sensors_read(jobs)
        self._shown = nodes.shown
        self._waited_at = time.monotonic()

    def prepare(self) -> None:
        """Start processes on the nodes, and wait until one is ready; ExecutorError if no node can play."""
        while not any(host.is_ready for host in self._hosts):
            self._start_hosts()
            self._check_nodes()
            for host, report in self._answers():
                if isinstance(report, Broken):
                    self._lose(host, report.reason)

    def run(self) -> Generator[Message, Any, None]:
        """Play all jobs; ExecutorError if all nodes were lost."""
        while self._waiting or any(host.number is not None for host in self._hosts):
            yield from self._assign()
            self._start_hosts()
            self._check_nodes()
            for host, report in self._answers():
                yield from self._hear(host, report)
            if self._nodes.shown != self._shown:
                self._shown = self._nodes.shown
                yield Nodes(self._shown)

    def _check_nodes(self) -> None:
        self._nodes.look()
        for host in [host for host in self._hosts if host.node.problem and host.number is None]:
            self._lose(host, host.node.problem)
        examining = any(node.examined is None for node in self._nodes)
        if not self._nodes.used and not examining:
            problems = "; ".join(f"{node.name}: {node.problem}" for node in self._nodes)
            raise ExecutorError(f"no node of the Ray cluster is left ({problems})")

    # Assigning matches, and starting processes for them.

    def _cores(self, number: int) -> int:
        return cores_of(self._jobs[number], max((node.cores for node in self._nodes.used), default=1))

    def _assign(self) -> Generator[Message, Any, None]:
        """Give the next matches to idle processes with the right number of cores."""
        while self._waiting:
            cores = self._cores(self._waiting[0])
            idle = [host for host in self._hosts if host.is_idle and host.cores == cores]
            if not idle:
                return
            number, host = self._waiting.popleft(), idle[0]
            files = yield Starting(number)
            if files is None:
                continue
            folders = {one.folder for one in self._jobs[number].submissions}
            shipments = {folder: self._shipments[folder] for folder in folders}
            host.number, host.silent, host.timeout = number, 0.0, START_TIME
            host.answer = host.actor.play.remote(self._jobs[number], shipments, files)
            host.node.running += 1

    def _start_hosts(self) -> None:
        """Start processes for waiting matches, as far as there are free cores."""
        coming = Counter(host.cores for host in self._hosts if host.is_idle or not host.is_ready)
        for number in self._waiting:
            cores = self._cores(number)
            if coming[cores]:
                coming[cores] -= 1  # one of them will play it
            elif not self._start_host(cores):
                self._make_room(coming)
                return

    def _start_host(self, cores: int) -> bool:
        """Start a process on the node with the most free cores; return whether one has enough."""
        node = max(self._nodes.used, key=lambda node: node.free, default=None)
        if node is None or node.free < cores or len(self._hosts) >= self._at_once:
            return False
        kind = ray.remote(num_cpus=cores, max_restarts=0, max_task_retries=0)(MatchHost)
        actor = kind.options(scheduling_strategy=node.strategy).remote(self._sensors)
        node.taken += cores
        self._hosts.append(Host(node, cores, actor, actor.prepare.remote()))
        return True

    def _make_room(self, unneeded: Mapping[int, int]) -> None:
        """Stop an idle process that has another number of cores than the next matches need.

        ``unneeded`` is how many processes with each number of cores no waiting match will take.
        """
        for host in self._hosts:
            if host.is_idle and unneeded[host.cores]:
                self._remove(host)
                return

    # Answers, and processes that were lost.

    def _answers(self) -> Generator[tuple[Host, Report | Broken], None, None]:
        """Wait for a short time, and yield the processes that answered or were lost."""
        by_answer = {host.answer: host for host in self._hosts if host.answer is not None}
        waited = min(2.0 * TICK, time.monotonic() - self._waited_at)
        self._waited_at = time.monotonic()
        if not by_answer:
            time.sleep(TICK / 10)
            return
        ready, _ = ray.wait(list(by_answer), num_returns=1, timeout=TICK)
        if ready:
            ready, _ = ray.wait(list(by_answer), num_returns=len(by_answer), timeout=0)
        for answer, host in by_answer.items():
            host.silent = 0.0 if answer in ready else host.silent + waited
            if answer in ready:
                yield host, self._report(host, answer)
            elif host.silent > host.timeout:
                yield host, Broken(f"{host.node.name} did not answer within {host.timeout:,.0f} s")

    def _report(self, host: Host, answer: Any) -> Report | Broken:
        host.answer = None
        try:
            report: Report | None = ray.get(answer)
        except RayError as error:
            return Broken(f"a process on {host.node.name} was lost: {_cause(error)}")
        host.is_ready, host.timeout, host.node.failures = True, SILENCE, 0
        return report or Report()

    def _hear(self, host: Host, report: Report | Broken) -> Generator[Message, Any, None]:
        """Pass on what a process reported, or what its loss means for its match."""
        number = host.number
        if isinstance(report, Broken):
            self._lose(host, report.reason)
            if number is not None:
                yield from self._broken(number, report.reason)
            return
        if number is None:
            return
        for event in report.events:
            if isinstance(event, AttemptFailed):
                self._jobs[number] = replace(
                    self._jobs[number], faults=(*self._jobs[number].faults, event.reason)
                )
            yield Happened(number, event)
        if report.end is None:
            host.answer = host.actor.report.remote()
            return
        host.number = None
        host.node.running -= 1
        if isinstance(report.end, Played):
            host.node.done += 1
            yield MatchEnded(number, report.end)
        else:
            yield from self._broken(number, report.end.reason)

    def _broken(self, number: int, reason: str) -> Generator[Message, Any, None]:
        """Let a match be played again, or give it up after too many attempts."""
        again = after_worker_death(self._jobs[number], reason)
        if isinstance(again, Job):
            self._jobs[number] = again
            self._waiting.appendleft(number)
            yield Happened(number, AttemptFailed(reason))
        else:
            yield MatchEnded(number, Played(again.row, again.timing, again.replay_error, {}))

    def _lose(self, host: Host, reason: str) -> None:
        """Note that a process is gone, or should be."""
        if host.is_ready:
            host.node.rest()  # a match may have ended it, so the node is not to blame
        else:
            host.node.note_failure(reason)
        self._remove(host)

    def _remove(self, host: Host) -> None:
        if host.number is not None:
            host.node.running -= 1
            host.number = None
        host.node.taken -= host.cores
        self._hosts.remove(host)
        ray.kill(host.actor)

    def close(self) -> None:
        """Stop all matches and all processes."""
        stops = [host.actor.stop.remote() for host in self._hosts if host.is_ready]
        if stops:
            ray.wait(stops, num_returns=len(stops), timeout=STOP_TIME)
        for host in list(self._hosts):
            self._remove(host)


def _cause(error: RayError) -> str:
    """Return in a few words why Ray lost a process."""
    text = str(error)
    if "worker process has died" in text:
        return "it was killed, or ended"
    if "unavailable" in text:
        return "the node cannot be reached"
    if "node" in text and "dead" in text:
        return "the node is dead"
    return last_line(error)
