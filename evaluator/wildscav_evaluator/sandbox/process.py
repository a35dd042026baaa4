"""The sandbox that is none: a plain process, for development and for agents that one trusts.

The agent runs as the user who started the evaluation, sees that user's files and has the network. What is
kept is the tidiness of the host: a session of its own, a bare environment, one thread for numerics, a
bounded log, and an end together with the evaluation, whatever ends that.
"""

import asyncio
import contextlib
import os
import signal
import sys
from pathlib import Path

from wildscav_evaluator.sandbox.base import Launch
from wildscav_evaluator.sandbox.log import CappedLog

GRACE = 0.5  # s, for an ended agent's output to end; less than a match waits for the agent's last words
KILL_ROUNDS = 1000  # the most looks at a session that keeps forking

# Numerics libraries start a thread a core each; matches run side by side, one a core.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
PASSED_ON = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "LD_LIBRARY_PATH")

# Like `python -m wildscav.sdk`, but on Linux the kernel ends the agent when its parent is gone, so that not
# even a killed evaluation leaves agents behind.
STARTER = """
import ctypes, os, runpy, signal, sys
if sys.platform == "linux":
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    if os.getppid() != int(sys.argv.pop(1)):
        sys.exit(4)
runpy.run_module("wildscav.sdk", run_name="__main__", alter_sys=True)
"""


class ProcessSandbox:
    """Runs an agent as a plain process."""

    isolated = False

    async def start(self, launch: Launch) -> "AgentProcess":
        """Start an agent. See ``Sandbox.start``."""
        arguments = [sys.executable, "-c", STARTER]
        if sys.platform == "linux":
            arguments.append(str(os.getpid()))
        # A pipe of our own: asyncio's would keep `wait` waiting for every child that holds it open.
        ours, theirs = os.pipe()
        try:
            process = await asyncio.create_subprocess_exec(
                *arguments,
                launch.entry_point,
                cwd=launch.folder,
                env=environment(launch),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=theirs,
                stderr=asyncio.subprocess.STDOUT,
                start_new_session=True,
            )
        except BaseException:
            os.close(ours)
            raise
        finally:
            os.close(theirs)
        return AgentProcess(process, CappedLog(launch.log), *await _open_stream(ours))


async def _open_stream(pipe: int) -> tuple[asyncio.StreamReader, asyncio.ReadTransport]:
    """Return the reading end of a pipe as a stream, and what closes it."""
    stream = asyncio.StreamReader()
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(stream), os.fdopen(pipe, "rb", buffering=0)
    )
    return stream, transport


def environment(launch: Launch) -> dict[str, str]:
    """Return the agent's environment variables: what Python and the SDK need, nothing of the user's own."""
    passed_on = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    return {
        **passed_on,
        **ONE_THREAD,
        "PYTHONUNBUFFERED": "1",  # so that the log has the last words of an agent that is killed
        "PYTHONDONTWRITEBYTECODE": "1",  # a submission's folder stays as it was digested
        "WILDSCAV_ADDRESS": launch.address,
        "WILDSCAV_TOKEN": launch.token,
    }


class AgentProcess:
    """One agent's process and all that it started."""

    def __init__(
        self,
        process: asyncio.subprocess.Process,
        log: CappedLog,
        output: asyncio.StreamReader,
        pipe: asyncio.ReadTransport,
    ) -> None:
        self._process, self._log, self._pipe = process, log, pipe
        self._copying = asyncio.create_task(log.copy(output))

    async def ended(self) -> str:
        """Wait for the process to end. See ``RunningAgent.ended``."""
        code = await self._process.wait()
        await self._finish_log()
        words = f"exit code {code}" if code >= 0 else f"killed by {signal_name(-code)}"
        last = self._log.last_words()
        return f"the agent's process ended ({words})" + (f": {last}" if last else "")

    async def stop(self) -> None:
        """Kill the agent's whole session. See ``RunningAgent.stop``."""
        kill_session(self._process.pid)
        await self._process.wait()
        kill_session(self._process.pid)
        await self._finish_log()

    async def _finish_log(self) -> None:
        # A child that outlives its parent may hold the pipe open: the log then ends without it.
        _, late = await asyncio.wait([self._copying], timeout=GRACE)
        if late:
            self._copying.cancel()
            await asyncio.wait([self._copying])
        self._pipe.close()
        await asyncio.sleep(0)  # in which it is closed


def signal_name(number: int) -> str:
    """Return a signal's name, such as SIGKILL."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


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
