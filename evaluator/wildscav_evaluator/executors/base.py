"""The interface of executors, which play matches and call functions on one machine or on many."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Protocol, Self, TypeVar

from wildscav.errors import UserError
from wildscav_evaluator.matches.jobs import Job, JobEvent, JobResult
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.sandbox.choose import Choice
from wildscav_evaluator.submissions.submission import Submission

Item = TypeVar("Item")
Value = TypeVar("Value")

OnStart = Callable[[Job], bool | None]
OnEvent = Callable[[Job, JobEvent], None]


class ExecutorError(UserError):
    """An executor cannot be used, or was lost in the middle of its work."""


@dataclass(frozen=True)
class Node:
    """One machine of a cluster."""

    name: str
    cores: int
    running: int = 0  # matches that are being played
    done: int = 0  # matches that ended
    problem: str = ""  # why it gets no work; empty if it does


@dataclass(frozen=True)
class Examined:
    """What was found on a machine of a cluster."""

    name: str
    cores: int
    problem: str = ""  # why it can get no work at all, whatever the sandbox
    sandboxes: Mapping[str, str] = field(default_factory=dict)  # the broken promises of each; empty if none


class Players(Protocol):
    """What plays matches; an executor made it ready."""

    def run(
        self,
        jobs: Sequence[Job],
        on_start: OnStart = lambda _: None,
        on_event: OnEvent = lambda _job, _event: None,
    ) -> Iterator[JobResult]:
        """Play all jobs, and yield their results as they arrive, with all files in the output folder.

        A match that the platform broke is played again from its start, up to ``MAX_ATTEMPTS`` in all.

        Args:
            jobs: The jobs, in the order in which to start them.
            on_start: Called with every job before it is started, or started again; if it returns False, the
                job is left out, and has no result.
            on_event: Called with the progress of each match, and with what broke an attempt.

        Raises:
            ExecutorError: There is nothing left that could play them.
        """
        ...


class Executor(Protocol):
    """Where matches are played. It is a context manager, which stops everything when it exits."""

    name: str

    def __init__(self, at_once: int | None = None, address: str | None = None) -> None:
        """Create an executor; nothing is started or connected before ``__enter__``.

        Args:
            at_once: How many matches or calls at once, at most; None for as many as there are cores.
            address: The address of a cluster; None for the executor's own default.

        Raises:
            UserError: The executor takes no address, or a package that it needs is not installed.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    @property
    def at_once(self) -> int:
        """How many matches of one seat it plays at once, at most."""
        ...

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The machines of its cluster as they are now; empty if it uses this machine alone."""
        ...

    def examine(self, sandboxes: Sequence[str]) -> tuple[Examined, ...]:
        """Try sandboxes on all machines of its cluster; nothing if it uses this machine alone.

        Raises:
            ExecutorError: The cluster was lost.
        """
        ...

    def choose_sandbox(
        self, asked: str | None, submissions: Sequence[Submission]
    ) -> tuple[Choice, tuple[Submission, ...]]:
        """Try sandboxes where matches will be played; return the one to use, and the submissions for it.

        Args:
            asked: The name of the sandbox; None for the strongest that works.

        Raises:
            SandboxError: The sandbox asked for does not keep its promises.
            SubmissionError: A submission cannot run in the sandbox.
        """
        ...

    def players(self, jobs: Sequence[Job], lock: Lock | None = None) -> AbstractContextManager[Players]:
        """Make ready what plays some jobs: this includes compiling the engine.

        Args:
            lock: The lock of the output folder, for processes that write to it themselves.

        Raises:
            ExecutorError: Nothing can play them.
        """
        ...

    def map(self, function: Callable[[Item], Value], items: Iterable[Item]) -> Iterator[Value]:
        """Call a function with each item in other processes, and yield the values in the order of the items.

        Args:
            function: A function of a module; it gets and returns values that can be pickled.
            items: Taken one by one as they are needed.

        Raises:
            ExecutorError: There is nothing left that could call it.
        """
        ...
