"""The interface of all sandboxes: start an agent, report how it ended, and leave nothing of it behind."""

import signal
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Protocol

from wildscav.errors import UserError
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits
from wildscav_evaluator.sandbox.processor_waits import GroupMeter
from wildscav_server.time_limits import MARGIN


class SandboxError(UserError):
    """A sandbox cannot keep its promises on this machine, or cannot start an agent at all."""


@dataclass(frozen=True)
class Launch:
    """Everything that a sandbox needs to start one agent for one match."""

    folder: Path  # of the submission; the agent's working directory, which it cannot change
    entry_point: str  # "module:Class"; empty if it has a command
    address: str  # of the match server, or of the bridge to it: "unix:/path" of the socket of this seat
    token: str  # of the seat
    log: Path  # the file for the agent's output
    limits: Limits = field(default=DEFAULT_LIMITS)
    image: str | None = None  # of a submission that was built into an image or is one
    command: tuple[str, ...] = ()  # to run instead of Python
    start_limit: float | None = None  # s that the agent has to start up
    interface: str = "numbers"  # by which it plays: "numbers", "words" or "keys"
    lasts: float = MARGIN  # s from its start after which the sandbox ends it, because its match hangs
    model: str | None = None  # the address of this seat's gateway to a model: "unix:/path"


class MemoryKill(Enum):
    """Whose memory ran out, if the kernel killed processes of an agent."""

    NONE = "it killed none"
    OWN = "the agent's: it was at its limit"
    MACHINES = "the machine's, or of all that is evaluated: the agent was within its limit"


@dataclass(frozen=True)
class Ending:
    """How an agent's process ended by itself, or by a limit."""

    exit_code: int | None = None  # None if a signal ended it
    killed_by: str = ""  # the signal, such as SIGKILL
    out_of_memory: bool = False  # it was killed because it needed more memory than its limit
    limit: str = ""  # the limit that ended it, such as "wall clock"
    last_words: str = ""  # the exception that ended it, or its last line of output
    last_lines: tuple[str, ...] = ()  # the last lines of its output
    platform_fault: str = ""  # what failed in the platform, in one line; then the agent is not to blame

    def __str__(self) -> str:
        """Return a description in one line."""
        if self.platform_fault:
            return self.platform_fault
        if self.out_of_memory:
            how = "out of memory"
        elif self.limit:
            how = f"its {self.limit} is used up"
        elif self.killed_by:
            how = f"killed by {self.killed_by}"
        else:
            how = f"exit code {self.exit_code}"
        return f"the agent's process ended ({how})" + (f": {self.last_words}" if self.last_words else "")


@dataclass(frozen=True)
class Promise:
    """A promise of a sandbox, and whether a test on this machine showed that it is kept."""

    name: str
    kept: bool
    found: str  # what the test found
    remedy: str = ""  # what to install or set, if it is not kept


class RunningAgent(Protocol):
    """A handle on an agent that was started."""

    async def ended(self) -> Ending:
        """Wait until the agent's process ends by itself or by a limit, and return how it ended."""
        ...

    def meter(self) -> GroupMeter | None:
        """Return what measures its waits for a processor; None if this sandbox cannot."""
        ...

    def overdue(self) -> str:
        """Return where the agent's code was when its time was up; an empty text if it is not known."""
        ...

    async def stop(self) -> None:
        """End the agent and every process that it started, and finish its log. May be called twice."""
        ...


class Sandbox(Protocol):
    """A way to run agents."""

    name: str
    isolated: bool  # whether it keeps an agent from the host's files, network and other processes
    runs_images: bool  # whether it runs images of this machine's container engine, besides folders

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        """Test all promises of the sandbox on this machine, with these limits. Takes about a second."""
        ...

    async def start(self, launch: Launch) -> RunningAgent:
        """Start an agent.

        Raises:
            SandboxError: It failed, or cannot set a limit; another attempt may succeed.
            UserError: It does not run such submissions.
            OSError: No process could be started, or the log cannot be written.
        """
        ...


def signal_name(number: int) -> str:
    """Return a signal's name, such as SIGKILL."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
