"""A sandbox without isolation: a plain process, for development and for trusted agents.

The agent runs as the user who started the evaluation, sees that user's files and can use the network. The
sandbox only keeps the host tidy: a separate session, a minimal environment, one thread for numerical
libraries, a bounded log, a wall clock, and an end together with the evaluation, however that ends.
"""

import asyncio
import contextlib
import os
import shutil
import signal
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from wildscav.errors import UserError
from wildscav.system import leftovers
from wildscav_evaluator.sandbox.agents.agent_process import AgentProcess, agent_variables, start_process
from wildscav_evaluator.sandbox.base import Launch, MemoryKill, Promise
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.submission_files import stage

KILL_ROUNDS = 1000  # rounds, at most, of killing a session that keeps forking
PASSED_ON = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "LD_LIBRARY_PATH")
DANGER = "agents run as plain processes: they can use your files, your network and the whole machine"
WARNING = f"{DANGER}. For code that you do not trust, use --sandbox oci or bubblewrap (`wildscav doctor`)"

# Like `python -m wildscav.sdk` or a submission's own command, except that on Linux the kernel kills the agent
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

    def promises(self, limits: Limits) -> tuple[Promise, ...]:  # noqa: ARG002 - it promises nothing
        """Return no promises. See ``Sandbox.promises``."""
        return ()

    async def start(self, launch: Launch) -> AgentProcess:
        """Start an agent. See ``Sandbox.start``."""
        if launch.image is not None:
            raise UserError(f"image {launch.image} needs --sandbox oci: a plain process runs folders only")
        arguments = [sys.executable, "-c", STARTER]
        if sys.platform == "linux":
            arguments.append(str(os.getpid()))
        handle = SessionHandle()
        try:
            folder = await asyncio.to_thread(stage, launch.folder, handle.private)
            agent = await start_process(
                [*arguments, *(("--", *launch.command) if launch.command else (launch.entry_point,))],
                replace(launch, folder=folder),
                handle,
                environment=environment(launch),
                folder=folder,
            )
        except BaseException:
            await handle.release()
            raise
        handle.session = agent.pid
        return agent


def environment(launch: Launch) -> dict[str, str]:
    """Return the agent's environment variables: what Python and the SDK need, and no others of the user."""
    passed_on = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    return passed_on | agent_variables(launch, launch.address)


class SessionHandle:
    """A handle on an agent: its session of processes."""

    def __init__(self) -> None:
        self.session: int | None = None
        self.private = Path(
            tempfile.mkdtemp(prefix="code-", dir=leftovers.own_folder())
        )  # for a copy of the code

    def meter(self) -> None:
        """Return that waits cannot be measured, because nothing tells apart its own from those for others."""

    async def kill(self) -> None:
        """Kill the session. See ``AgentHandle.kill``."""
        if self.session is not None:
            kill_session(self.session)

    async def memory_kill(self, code: int) -> MemoryKill:  # noqa: ARG002
        """Return that none was killed, because nothing counts kills. See ``AgentHandle.memory_kill``."""
        return MemoryKill.NONE

    async def release(self) -> None:
        """Remove the copy of the code. See ``AgentHandle.release``."""
        await asyncio.to_thread(shutil.rmtree, self.private, ignore_errors=True)


def kill_session(session: int) -> None:
    """Kill every process of a session, in all its process groups, except zombies.

    The kernel does not give a session's number to a new process while the session has members, so no other
    processes can be killed.
    """
    if not Path("/proc/self/stat").exists():
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(session, signal.SIGKILL)
        return
    # A process may fork while the list is read, so repeat until no process is left.
    for _ in range(KILL_ROUNDS):
        members = _members(session)
        for process in members:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        if not members:
            return


def _members(session: int) -> list[int]:
    """Return the living processes of a session, from Linux's /proc."""
    members = []
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            # "pid (name) state parent group session …"; the name may hold spaces and brackets.
            state, _, _, its_session = (entry / "stat").read_text().rpartition(")")[2].split()[:4]
            if int(its_session) == session and state not in "ZX":
                members.append(int(entry.name))
    return members
