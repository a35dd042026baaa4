"""The executor of a Ray cluster: this program's side of it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from typing import Any, Self, cast

from wildscav.errors import describe
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.executors.base import Examined, ExecutorError, Item, Node, OnEvent, OnStart, Value
from wildscav_evaluator.executors.cluster.bridge import Bridge, check_installed
from wildscav_evaluator.executors.cluster.connection import check_address
from wildscav_evaluator.executors.cluster.messages import (
    Call,
    Examine,
    Happened,
    MatchEnded,
    Nodes,
    Play,
    Played,
    Prepare,
    Question,
    Returned,
    Starting,
    Use,
)
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobResult
from wildscav_evaluator.matches.run_job import failed
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox import SANDBOXES, SandboxError
from wildscav_evaluator.sandbox.choose import Choice
from wildscav_evaluator.sandbox.process import WARNING
from wildscav_evaluator.submissions.images import built_name, lacks_packages
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.manifest import SubmissionError

EVERYTHING = 1 << 30  # matches at once: as many as the nodes' cores allow


class RayExecutor:
    """Plays matches and calls functions on the nodes of a Ray cluster. See ``Executor``."""

    name = "ray"

    def __init__(self, at_once: int | None = None, address: str | None = None) -> None:
        check_installed()
        self._at_once, self._address = at_once, address
        self._bridge: Bridge | None = None
        self._nodes: tuple[Node, ...] = ()

    def __enter__(self) -> Self:
        if self._address is not None:
            check_address(self._address)  # at once, instead of in the bridge's process
        self._bridge = Bridge(self._address)
        return self

    def __exit__(self, *_: object) -> None:
        """Stop everything that runs on the cluster."""
        if self._bridge is not None:
            self._bridge.close()

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes of the cluster. See ``Executor``."""
        return self._nodes

    @property
    def at_once(self) -> int:
        """How many matches of one seat at once, at most."""
        cores = sum(node.cores for node in self._nodes if not node.problem)
        return max(1, min(cores, self._at_once or EVERYTHING))

    def examine(self, sandboxes: Sequence[str], images: Sequence[str] = ()) -> tuple[Examined, ...]:
        """Try sandboxes on all nodes, and return what was found on each."""
        (found,) = self._request(Examine(tuple(sandboxes), tuple(images)))
        return cast("tuple[Examined, ...]", found)

    def choose_sandbox(
        self, asked: str | None, submissions: Sequence[Submission]
    ) -> tuple[Choice, tuple[Submission, ...]]:
        """Try sandboxes on all nodes; by default, use the one that works on most cores. See ``Executor``.

        Agents run as plain processes only if that is asked for.
        """
        images = [one for one in submissions if one.image is not None or lacks_packages(one)]
        names = [asked] if asked else [name for name in SANDBOXES.built_in if SANDBOXES[name].isolated]
        names = [name for name in names if SANDBOXES[name].runs_images or not images]
        if not names:
            raise SubmissionError(f"{images[0].name} needs a container, which --sandbox {asked} does not run")
        examined = self.examine(names, [one.image or built_name(one) for one in images])
        usable = [one for one in examined if not one.problem]
        cores = {name: sum(one.cores for one in usable if not one.sandboxes[name]) for name in names}
        best = max(names, key=lambda name: cores[name])
        if not cores[best]:
            raise SandboxError(_no_sandbox(examined, names))
        for message in self._request(Use(best)):
            self._nodes = cast("Nodes", message).nodes
        unused = tuple(f"node {one.name} is not used: {one.problem}" for one in self._nodes if one.problem)
        warnings = unused if SANDBOXES[best].isolated else (WARNING, *unused)
        return Choice(SANDBOXES[best], warnings), tuple(submissions)

    @contextmanager
    def players(
        self,
        jobs: Sequence[Job],
        lock: Lock | None = None,  # noqa: ARG002 - only this process writes to the folder
    ) -> Iterator[Self]:
        """Bring the submissions to the cluster, and compile the engine there. See ``Executor``."""
        if not self._nodes:
            self.choose_sandbox(jobs[0].sandbox, [one for job in jobs for one in job.submissions])
        for _ in self._request(Prepare(tuple(jobs), self._at_once or EVERYTHING)):
            pass
        yield self

    def map(self, function: Callable[[Item], Value], items: Iterable[Item]) -> Iterator[Value]:
        """Call a function on the nodes, one core for each call. See ``Executor``."""
        if not self._nodes:
            self._use_any_sandbox()
        iterator = iter(items)
        values: dict[int, Value] = {}
        following = 0
        request = Call(function, self._at_once or EVERYTHING)
        for message in self._request(request, lambda _: tuple(islice(iterator, 1))):
            returned = cast("Returned", message)
            values[returned.number] = returned.value
            while following in values:
                yield values.pop(following)
                following += 1

    def _use_any_sandbox(self) -> None:
        """Use all nodes with this version of Wildscav: calls run no agents."""
        examined = self.examine(())
        for message in self._request(Use("")):
            self._nodes = cast("Nodes", message).nodes
        if all(one.problem for one in examined):
            raise ExecutorError(_no_node(examined))

    def _request(self, request: Any, answer: Callable[[Any], Any] = lambda _: None) -> Iterator[Any]:
        if self._bridge is None:
            raise RuntimeError("the executor is not entered")
        return self._bridge.request(request, answer)

    def run(
        self,
        jobs: Sequence[Job],
        on_start: OnStart = lambda _: None,
        on_event: OnEvent = lambda _job, _event: None,
    ) -> Iterator[JobResult]:
        """Play the jobs that the cluster was made ready for. See ``Players``."""
        mine = list(jobs)

        def start(question: Question) -> Mapping[str, bytes] | None:
            job = mine[cast("Starting", question).number]
            return None if on_start(job) is False else files_of_earlier_run(job)

        for message in self._request(Play(), start):
            if isinstance(message, Nodes):
                self._nodes = message.nodes
            elif isinstance(message, Happened):
                job = mine[message.number]
                if isinstance(message.event, AttemptFailed):
                    job = mine[message.number] = replace(job, faults=(*job.faults, message.event.reason))
                on_event(job, message.event)
            elif isinstance(message, MatchEnded):
                yield saved(mine[message.number], message.played)


def files_of_earlier_run(job: Job) -> dict[str, bytes]:
    """Return the files that a node needs for a match that was played, and lacks only its replay."""
    return {} if job.kept is None else {job.record: (job.out / job.record).read_bytes()}


def saved(job: Job, played: Played) -> JobResult:
    """Write the files of a match that a node played, as a local worker does, and return its result."""
    result = JobResult(job, played.row, played.timing, played.replay_error)
    try:
        if job.kept is None and played.row.record is not None:
            for path in played.files:
                if path != job.replay_path:
                    (job.out / path).parent.mkdir(exist_ok=True)
                    write_whole(job.out / path, played.files[path])
    except OSError as error:
        return failed(job, describe(error))
    if played.row.replay is None:
        return result
    replay = job.out / job.replay_path
    try:
        write_whole(replay, played.files[job.replay_path])
    except OSError as error:
        row = played.row.model_copy(update={"replay": None})
        return replace(result, row=row, replay_error=f"no replay {replay}: {error.strerror or error}")
    return result


def _no_sandbox(examined: Sequence[Examined], names: Sequence[str]) -> str:
    """Return in one line why no node can run agents."""
    if not examined or all(one.problem for one in examined):
        return _no_node(examined)
    why = "; ".join(
        f"{one.name}: {one.problem or ', '.join(f'{name}: {one.sandboxes[name]}' for name in names)}"
        for one in examined
    )
    return (
        f"no node of the Ray cluster can run agents in {' or '.join(names)} ({why}); to run agents that you "
        "trust as plain processes, name --sandbox process"
    )


def _no_node(examined: Sequence[Examined]) -> str:
    if not examined:
        return "the Ray cluster has no node with cores"
    why = "; ".join(f"{one.name}: {one.problem}" for one in examined)
    return f"no node of the Ray cluster can be used ({why})"
