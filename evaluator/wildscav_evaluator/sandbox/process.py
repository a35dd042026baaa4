"""The sandbox that is none: a plain process, for development and for agents that one trusts.

The agent runs as the user who started the evaluation, sees that user's files and has the network. What is
kept is the tidiness of the host: a session of its own, a bare environment, one thread for numerics, a
bounded log, a wall clock, and an end together with the evaluation, whatever ends that.
"""

import contextlib
import os
import signal
import sys
from pathlib import Path

from wildscav_evaluator.sandbox.agents.agent_process import AgentProcess, agent_variables, start_process
from wildscav_evaluator.sandbox.base import Launch, MemoryKill, Promise, SandboxError
from wildscav_evaluator.sandbox.limits import Limits

KILL_ROUNDS = 1000  # the most looks at a session that keeps forking
PASSED_ON = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "LD_LIBRARY_PATH")
WARNING = (
    "agents run as plain processes: they have your files, your network and all of the machine. "
    "For code that you would not run yourself use --sandbox oci or bubblewrap (`wildscav doctor`)"
)

# Like `python -m wildscav.sdk`, or like a submission's own command, but on Linux the kernel ends the agent
# when its parent is gone, so that not even a killed evaluation leaves agents behind.
STARTER = """
import ctypes, os, runpy, signal, sys
if sys.platform == "linux":
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    if os.getppid() != int(sys.argv.pop(1)):
        sys.exit(4)
if sys.argv[1] == "--":
    try:
        os.execvp(sys.argv[2], sys.argv[2:])
    except OSError as error:
        sys.exit(f"cannot run {sys.argv[2]}: {error.strerror}")
runpy.run_module("wildscav.sdk", run_name="__main__", alter_sys=True)
"""


class ProcessSandbox:
    """Runs an agent as a plain process."""

    name = "process"
    isolated = False
    runs_images = False

    def promises(self, limits: Limits) -> tuple[Promise, ...]:  # noqa: ARG002 - it keeps none of them
        """Say that nothing is promised. See ``Sandbox.promises``."""
        return ()

    async def start(self, launch: Launch) -> AgentProcess:
        """Start an agent. See ``Sandbox.start``."""
        if launch.image is not None:
            raise SandboxError(f"image {launch.image} needs --sandbox oci: a plain process runs folders only")
        arguments = [sys.executable, "-c", STARTER]
        if sys.platform == "linux":
            arguments.append(str(os.getpid()))
        handle = SessionHandle()
        agent = await start_process(
            [*arguments, *(("--", *launch.command) if launch.command else (launch.entry_point,))],
            launch,
            handle,
            environment=environment(launch),
            folder=launch.folder,
        )
        handle.session = agent.pid
        return agent


def environment(launch: Launch) -> dict[str, str]:
    """Return the agent's environment variables: what Python and the SDK need, nothing of the user's own."""
    passed_on = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    return passed_on | agent_variables(launch, launch.address)


class SessionHandle:
    """A handle on the session of processes that an agent is."""

    session: int | None = None

    def processes(self) -> list[int]:
        """Return the first process, which plays. See ``AgentHandle.processes``."""
        return [] if self.session is None else [self.session]

    async def kill(self) -> None:
        """Kill the session. See ``AgentHandle.kill``."""
        if self.session is not None:
            kill_session(self.session)

    async def memory_kill(self, code: int) -> MemoryKill:  # noqa: ARG002
        """Return none: nobody counts."""
        return MemoryKill.NONE

    async def release(self) -> None:
        """Do nothing: there is nothing besides the processes."""


def kill_session(session: int) -> None:
    """Kill every process of a session, in whatever process group it hides, zombies aside.

    A session's number is not given to a new process while the session has members, so none but its own
    processes can be hit.
    """
    if not Path("/proc/self/stat").exists():
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(session, signal.SIGKILL)
        return
    # A process may fork while the list is read: look again until nobody is left.
    for _ in range(KILL_ROUNDS):
        members = _members(session)
        for process in members:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        if not members:
            return


def _members(session: int) -> list[int]:
    """Return the living processes of a session, by Linux's /proc."""
    members = []
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            # "pid (name) state parent group session …"; the name may hold spaces and brackets.
            state, _, _, its_session = (entry / "stat").read_text().rpartition(")")[2].split()[:4]
            if int(its_session) == session and state not in "ZX":
                members.append(int(entry.name))
    return members
