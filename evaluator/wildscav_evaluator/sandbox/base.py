"""What every sandbox does: start an agent, tell when it ends, and leave nothing of it behind."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


@dataclass(frozen=True)
class Launch:
    """All that a sandbox needs to start one agent for one match."""

    folder: Path  # the submission's; the agent's working directory
    entry_point: str  # "module:Class"
    address: str  # of the match server; a unix socket, so that a sandbox can do without network
    token: str  # of the seat
    log: Path  # where what the agent prints goes


class RunningAgent(Protocol):
    """One agent that was started."""

    async def ended(self) -> str:
        """Wait until the agent's process is gone by itself and return how it ended, in one line."""
        ...

    async def stop(self) -> None:
        """End the agent and every process that it started, and finish its log. May be called twice."""
        ...


class Sandbox(Protocol):
    """A way to run agents."""

    isolated: bool  # whether it keeps an agent from the host's files, network and other processes

    async def start(self, launch: Launch) -> RunningAgent:
        """Start an agent.

        Raises:
            OSError: No process could be started, or the log cannot be written.
        """
        ...
