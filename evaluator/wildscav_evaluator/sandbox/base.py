"""What every sandbox does: start an agent, tell how it ended, and leave nothing of it behind."""

import signal
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Protocol

from wildscav.errors import UserError
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits


class SandboxError(UserError):
    """A sandbox cannot keep what it promises on this machine, or cannot start an agent at all."""


@dataclass(frozen=True)
class Launch:
    """All that a sandbox needs to start one agent for one match."""

    folder: Path  # the submission's; read-only for the agent, and its working directory
    entry_point: str  # "module:Class"; empty if it has a command
    address: str  # of the match server: "unix:/path" of a socket that is this seat's alone
    token: str  # of the seat
    log: Path  # where what the agent prints goes
    limits: Limits = field(default=DEFAULT_LIMITS)
    image: str | None = None  # of a submission that was built or came as an image
    command: tuple[str, ...] = ()  # to run instead of Python
    start_limit: float | None = None  # s that the agent has to start up


class MemoryKill(Enum):
    """For want of whose memory the kernel killed processes of an agent."""

    NONE = "it killed none"
    OWN = "the agent's: it was at its limit"
    MACHINES = "the machine's, or of all that is evaluated: the agent was within its limit"


@dataclass(frozen=True)
class Ending:
    """How an agent's process ended by itself, or by a limit."""

    exit_code: int | None = None  # none if a signal ended it
    killed_by: str = ""  # the signal, such as SIGKILL
    out_of_memory: bool = False  # it was ended because it wanted more memory than it may have
    limit: str = ""  # the limit that ended it, such as "wall clock"
    last_words: str = ""  # the exception it died of, or its last line
    last_lines: tuple[str, ...] = ()  # of its output
    platform_fault: str = ""  # what of ours failed under it, in a line: the agent is not to blame

    def __str__(self) -> str:
        """Return it in one line."""
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
    """One thing that a sandbox promises, and whether it is kept on this machine: tried, not assumed."""

    name: str
    kept: bool
    found: str  # what was seen when it was tried
    remedy: str = ""  # what to install or set, if it is not kept


class RunningAgent(Protocol):
    """One agent that was started."""

    async def ended(self) -> Ending:
        """Wait until the agent's process is gone by itself, or by a limit, and return how it ended."""
        ...

    def processes(self) -> list[int]:
        """Return the numbers of its processes on this machine, as far as they are known."""
        ...

    def overdue(self) -> str:
        """Say where the agent's code was when its time was up, in a few words; nothing if it is not known."""
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
        """Try everything that the sandbox promises on this machine, with these limits. Takes a second."""
        ...

    async def start(self, launch: Launch) -> RunningAgent:
        """Start an agent.

        Raises:
            SandboxError: A limit cannot be kept; says which.
            OSError: No process could be started, or the log cannot be written.
        """
        ...


def signal_name(number: int) -> str:
    """Return a signal's name, such as SIGKILL."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
