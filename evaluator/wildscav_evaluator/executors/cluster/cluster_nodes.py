"""The nodes of a cluster: which there are, which may get work, and what is running on each."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import ray
from ray.exceptions import GetTimeoutError, RayError
from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

from wildscav_evaluator.executors.base import Examined, Node
from wildscav_evaluator.executors.cluster.messages import Examine
from wildscav_evaluator.executors.cluster.node_examination import examine, mismatch

EXAMINATION_TIME = 180.0  # s for a node to try its sandboxes, at most
LOOK_INTERVAL = 5.0  # s between two looks at which nodes there are
PAUSE = 5.0  # s in which a node gets no new process after one of its processes was lost
MAX_FAILURES = 3  # processes in a row that a node could not start


@dataclass
class ClusterNode:
    """A node of the cluster."""

    key: str  # Ray's id of it
    name: str
    cores: int
    examined: Examined | None = None  # None until it has answered
    problem: str = ""  # why it gets no work
    taken: int = 0  # cores that our processes there have reserved
    running: int = 0
    done: int = 0
    failures: int = 0  # in a row
    rests_until: float = 0.0  # s, on the monotonic clock
    examination: Any = field(default=None, repr=False)  # the reference to the answer

    @property
    def is_used(self) -> bool:
        """Whether it may get work."""
        return self.examined is not None and not self.problem

    @property
    def free(self) -> int:
        """Cores that it can give to new processes now."""
        return self.cores - self.taken if self.is_used and time.monotonic() >= self.rests_until else 0

    @property
    def strategy(self) -> NodeAffinitySchedulingStrategy:
        """What makes Ray run something on this node and on no other."""
        return NodeAffinitySchedulingStrategy(self.key, soft=False)

    @property
    def shown(self) -> Node:
        """The node as others see it."""
        return Node(self.name, self.cores, self.running, self.done, self.problem)

    def rest(self) -> None:
        """Start no process there for a while."""
        self.rests_until = time.monotonic() + PAUSE

    def note_failure(self, reason: str) -> None:
        """Note that a process of ours could not be started there."""
        self.failures += 1
        self.rest()
        if self.failures >= MAX_FAILURES:
            self.problem = f"it failed {self.failures} times in a row: {reason}"


class ClusterNodes:
    """All nodes of the cluster that have cores."""

    def __init__(self) -> None:
        self._nodes: dict[str, ClusterNode] = {}
        self._examine = Examine(())
        self._sandbox: str | None = None
        self._looked_at = 0.0

    def __iter__(self) -> Iterator[ClusterNode]:
        return iter(self._nodes.values())

    @property
    def used(self) -> list[ClusterNode]:
        """The nodes that may get work."""
        return [node for node in self if node.is_used]

    @property
    def shown(self) -> tuple[Node, ...]:
        """The nodes as others see them, without those that are still being examined."""
        return tuple(node.shown for node in self if node.examined is not None)

    def examine(self, request: Examine) -> tuple[Examined, ...]:
        """Examine all nodes, and return what was found on each."""
        self._nodes, self._examine, self._looked_at = {}, request, 0.0
        self.look()
        self._hear([node for node in self if node.examined is None], EXAMINATION_TIME)
        return tuple(node.examined for node in self if node.examined is not None)

    def use(self, sandbox: str) -> None:
        """Give work only to nodes that keep the promises of a sandbox, later ones included."""
        self._sandbox = sandbox
        for node in self:
            self._judge(node)

    def look(self) -> None:
        """Look which nodes there are, at times, and examine new ones; the dead get no work."""
        if time.monotonic() - self._looked_at >= LOOK_INTERVAL:
            self._looked_at = time.monotonic()
            self._update(ray.nodes())
        self._hear([node for node in self if node.examined is None], 0.0)

    def _update(self, nodes: Sequence[Mapping[str, Any]]) -> None:
        alive = {each["NodeID"]: each for each in nodes if each["Alive"]}
        for node in self:
            if node.key not in alive and not node.problem:
                node.problem = "it was lost"
        names = [_name(each) for each in alive.values()]
        for key, each in alive.items():
            cores = int(each["Resources"].get("CPU", 0))
            if key in self._nodes or cores < 1:
                continue
            name = _name(each)
            unique = name if names.count(name) == 1 else f"{name} ({key[:6]})"
            node = self._nodes[key] = ClusterNode(key, unique, cores)
            asked = ray.remote(num_cpus=0, max_retries=0)(examine).options(scheduling_strategy=node.strategy)
            node.examination = asked.remote(self._examine.sandboxes, self._examine.images)

    def _hear(self, asked: Sequence[ClusterNode], seconds: float) -> None:
        """Wait for the answers of nodes; after the time, those that did not answer have a problem."""
        references = [node.examination for node in asked]
        if not references:
            return
        ready, _ = ray.wait(references, num_returns=len(references), timeout=seconds)
        for node in asked:
            if node.examination in ready:
                node.examined = self._answer(node)
            elif seconds:
                problem = f"it did not answer within {seconds:.0f} s"
                node.examined = Examined(node.name, node.cores, problem)
            if node.examined is not None:
                self._judge(node)

    def _answer(self, node: ClusterNode) -> Examined:
        try:
            examination: dict[str, Any] = ray.get(node.examination, timeout=0)
        except (RayError, GetTimeoutError) as error:
            return Examined(node.name, node.cores, f"Wildscav does not run there: {last_line(error)}")
        problem = mismatch(examination) or "; ".join(filter(None, examination["images"].values()))
        return Examined(node.name, node.cores, problem, examination["sandboxes"])

    def _judge(self, node: ClusterNode) -> None:
        """Note why a node that was examined gets no work."""
        if node.examined is None or node.problem:
            return
        node.problem = node.examined.problem
        broken = node.examined.sandboxes.get(self._sandbox or "", "")
        if not node.problem and broken:
            node.problem = f"{self._sandbox} does not work there: {broken}"


def _name(node: Mapping[str, Any]) -> str:
    """Return the name that a node was given, or that of its machine."""
    name, address = str(node.get("NodeName", "")), str(node["NodeManagerAddress"])
    return name if name and name != address else f"{node['NodeManagerHostname']} ({address})"


def last_line(error: BaseException) -> str:
    """Return the last line of an error of Ray, which has the cause."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[-1][:300] if lines else type(error).__name__
