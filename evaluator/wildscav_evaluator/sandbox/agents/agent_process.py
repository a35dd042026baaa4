"""A running agent, the same in every sandbox: its process, its log, its wall clock, and its end."""

import asyncio
import os
import signal
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

from wildscav.sdk.run import INTERFACE_VARIABLE
from wildscav_evaluator.sandbox.agents import host_python
from wildscav_evaluator.sandbox.agents.capped_log import CappedLog
from wildscav_evaluator.sandbox.agents.tracebacks import last_words, overdue_stack
from wildscav_evaluator.sandbox.base import Ending, Launch, MemoryKill, signal_name
from wildscav_evaluator.sandbox.processor_waits import GroupMeter

GRACE = 0.5  # s for an ended agent's output to end; less than a match waits for the last words
SHORT_OF_MEMORY = "this machine is short of memory: the kernel killed an agent that was within its limit"
SIGNALLED = 128  # exit codes above are signals, by the convention of shells, bubblewrap and containers
LAST_SIGNAL = 64

# By default, numerical libraries start one thread per core; but matches run in parallel, one per core.
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)


def signal_of(code: int) -> int:
    """Return the signal that an exit code of Python (negative) or of shells stands for; 0 if none."""
    if code < 0:
        return -code
    return code - SIGNALLED if SIGNALLED < code <= SIGNALLED + LAST_SIGNAL else 0


def agent_variables(launch: Launch, address: str) -> dict[str, str]:
    """Return the environment variables that every agent gets; ``address`` is as the agent sees it."""
    # A sandbox that hides the machine's paths has another address of the match, too.
    model = launch.model if address == launch.address else host_python.MODEL
    return {
        **ONE_THREAD,
        "PYTHONUNBUFFERED": "1",  # so that the log has the last output of an agent that is killed
        "PYTHONDONTWRITEBYTECODE": "1",  # so that a submission's folder stays as it is
        "WILDSCAV_ADDRESS": address,
        "WILDSCAV_TOKEN": launch.token,
        **({} if launch.interface == "numbers" else {INTERFACE_VARIABLE: launch.interface}),
        **({} if launch.model is None or model is None else {"WILDSCAV_MODEL": model}),
        **({} if launch.start_limit is None else {"WILDSCAV_START_LIMIT": f"{launch.start_limit:g}"}),
    }


def python_command(launch: Launch) -> list[str]:
    """Return the agent's own command, or the command that runs its class with this machine's Python."""
    return list(launch.command) or [sys.executable, "-m", "wildscav.sdk", launch.entry_point]


class AgentHandle(Protocol):
    """A sandbox's handle on everything that one agent started."""

    def meter(self) -> GroupMeter | None:
        """Return what measures the agent's waits for a processor; None if the sandbox cannot."""
        ...

    async def kill(self) -> None:
        """Kill every process of the agent. May be called repeatedly."""
        ...

    async def memory_kill(self, code: int) -> MemoryKill:
        """Return whose memory ran out if the kernel killed processes of an agent that ended so."""
        ...

    async def release(self) -> None:
        """Remove what the sandbox set up for the agent, whose processes have ended. May be called twice."""
        ...


class AgentProcess:
    """One agent's process and everything that it started."""

    def __init__(
        self,
        process: asyncio.subprocess.Process,
        output: tuple[asyncio.StreamReader, asyncio.ReadTransport],
        launch: Launch,
        handle: AgentHandle,
    ) -> None:
        self._process, self._handle = process, handle
        self._folders = (host_python.CODE, launch.folder)  # where the agent's code is, inside and outside
        stream, self._pipe = output
        self._log = CappedLog(launch.log, launch.limits.output)
        self._limit = ""  # the limit that ended it
        self._stopping = False
        self._copying = asyncio.create_task(self._log.copy(stream))
        self._clock = asyncio.create_task(self._watch_clock(launch.lasts))

    @property
    def pid(self) -> int:
        """The number of its process, which is also that of its session."""
        return self._process.pid

    async def ended(self) -> Ending:
        """Wait for the process to end. See ``RunningAgent.ended``."""
        code = await self._process.wait()
        kill = await self._handle.memory_kill(code)
        # Processes that it left behind end with it, and so does its output.
        await self._handle.kill()
        await self._finish_log()
        signalled = signal_of(code)
        return Ending(
            exit_code=None if signalled else code,
            killed_by=signal_name(signalled) if signalled else "",
            out_of_memory=kill is MemoryKill.OWN and signalled == signal.SIGKILL and not self._limit,
            limit=self._limit,
            last_words=last_words(self._log.lines(), self._folders),
            last_lines=self._log.last_lines(),
            platform_fault=SHORT_OF_MEMORY if kill is MemoryKill.MACHINES and not self._limit else "",
        )

    def meter(self) -> GroupMeter | None:
        """Return what measures its waits for a processor. See ``RunningAgent.meter``."""
        return self._handle.meter()

    def overdue(self) -> str:
        """Return where the agent's code was when its time was up. See ``RunningAgent.overdue``."""
        return overdue_stack(self._log.lines(), self._folders)

    async def stop(self) -> None:
        """Kill all processes of the agent. See ``RunningAgent.stop``."""
        self._clock.cancel()
        await self._handle.kill()
        await self._process.wait()
        await self._handle.kill()
        await self._finish_log()
        await self._handle.release()

    async def _watch_clock(self, seconds: float) -> None:
        await asyncio.sleep(seconds)
        self._limit = "wall clock"
        await self._handle.kill()

    async def _finish_log(self) -> None:
        # A child that outlives its parent may hold the pipe open; the log then ends without its output.
        _, late = await asyncio.wait([self._copying], timeout=GRACE)
        if late:
            self._copying.cancel()
            await asyncio.wait([self._copying])
        self._pipe.close()
        await asyncio.sleep(0)  # lets the loop close it


async def start_process(
    arguments: Sequence[str],
    launch: Launch,
    handle: AgentHandle,
    *,
    kind: type[AgentProcess] = AgentProcess,
    environment: Mapping[str, str],
    folder: Path,
    pass_fds: Sequence[int] = (),
) -> AgentProcess:
    """Start a process in its own session, with its output going to the launch's log.

    The environment has all of its variables. OSError if it could not be started; the handle is released.
    """
    # Our own pipe: with asyncio's, `wait` would wait for every child that holds it open.
    ours, theirs = os.pipe()
    output = await _open_stream(ours)
    try:
        process = await asyncio.create_subprocess_exec(
            *arguments,
            cwd=folder,
            env=dict(environment),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=theirs,
            stderr=asyncio.subprocess.STDOUT,
            start_new_session=True,
            pass_fds=pass_fds,
        )
    except BaseException:
        output[1].close()
        await handle.release()
        raise
    finally:
        os.close(theirs)
    return kind(process, output, launch, handle)


async def _open_stream(pipe: int) -> tuple[asyncio.StreamReader, asyncio.ReadTransport]:
    """Return the reading end of a pipe as a stream, and the transport that closes it."""
    stream = asyncio.StreamReader()
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(stream), os.fdopen(pipe, "rb", buffering=0)
    )
    return stream, transport
