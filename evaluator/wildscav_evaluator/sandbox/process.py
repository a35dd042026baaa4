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
import threading
from dataclasses import replace
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.sandbox.agents.agent_process import AgentProcess, agent_variables, start_process
from wildscav_evaluator.sandbox.base import Launch, MemoryKill, Promise
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.sandbox.processes import all_processes, kill, open_process, read_file
from wildscav_evaluator.submission_files import stage
from wildscav_server import leftovers

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
        handle.lead(agent.pid)
        return agent


def environment(launch: Launch) -> dict[str, str]:
    """Return the agent's environment variables: what Python and the SDK need, and no others of the user."""
    passed_on = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    return passed_on | agent_variables(launch, launch.address)


class SessionHandle:
    """A handle on an agent: its session of processes."""

    def __init__(self) -> None:
        self._session: int | None = None  # None as soon as all of its processes have ended
        self._leader: int | None = None  # a pidfd of its first process
        self._lock = threading.Lock()  # of these two
        self.private = Path(
            tempfile.mkdtemp(prefix="code-", dir=leftovers.own_folder())
        )  # for a copy of the code

    def lead(self, leader: int) -> None:
        """Note the session's first process, by whose number the kernel calls the session."""
        self._session = leader
        if sys.platform == "linux":
            with contextlib.suppress(ProcessLookupError):
                self._leader = open_process(leader)

    def meter(self) -> None:
        """Return that waits cannot be measured, because nothing tells apart its own from those for others."""

    async def kill(self) -> None:
        """Kill the session. See ``AgentHandle.kill``."""
        await asyncio.to_thread(self._kill)  # which may take milliseconds, and other agents are being timed

    def _kill(self) -> None:
        with self._lock:
            if self._session is not None and kill_session(self._session, self._leader):
                self._session = None

    async def memory_kill(self, code: int) -> MemoryKill:  # noqa: ARG002
        """Return that none was killed, because nothing counts kills. See ``AgentHandle.memory_kill``."""
        return MemoryKill.NONE

    async def release(self) -> None:
        """Remove the copy of the code. See ``AgentHandle.release``."""
        await asyncio.to_thread(self._release)

    def _release(self) -> None:
        shutil.rmtree(self.private, ignore_errors=True)
        with self._lock:
            if self._leader is not None:
                os.close(self._leader)
            self._session = self._leader = None


def kill_session(session: int, leader: int | None) -> bool:
    """Kill every process of a session, in all its process groups, except zombies.

    Returns whether all have ended, so that its number may be another's from now on: the kernel does not give
    it to a new process while the session has members. ``leader`` is a pidfd of its first process, if there is
    one.
    """
    if not Path("/proc/self/stat").exists():
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(session, signal.SIGKILL)
            return False
        return True
    # A process may fork while the list is read, so repeat until no process is left.
    for _ in range(KILL_ROUNDS):
        members = [process for process in all_processes() if _session_of(process) == session]
        if not members or (session in members and leader is not None and _has_ended(leader)):
            return True
        for process in members:
            kill(process, lambda process: _session_of(process) == session)
    return False


def _has_ended(pidfd: int) -> bool:
    """Return whether a process has ended and is no zombie any more."""
    try:
        signal.pidfd_send_signal(pidfd, 0)
    except ProcessLookupError:
        return True
    return False


def _session_of(process: int) -> int:
    """Return the session of a living process; 0 if it has ended."""
    # "pid (name) state parent group session …"; the name may hold spaces and brackets.
    fields = read_file(process, "stat").rpartition(b")")[2].split()
    return int(fields[3]) if fields and fields[0] not in b"ZX" else 0
