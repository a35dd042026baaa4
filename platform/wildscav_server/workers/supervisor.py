"""Supervision of a shared server's workers: they are started, restarted when they end, and stopped."""

import asyncio
import contextlib
import json
import sys
from collections.abc import Sequence

import grpc

from wildscav.errors import UserError, WildscavError
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav_server.monitoring.logs import Log
from wildscav_server.workers.worker import WorkerConfig, WorkerReady

RESTART_DELAY = 1.0  # s until a worker that ended is restarted
START_TIMEOUT = 600.0  # s that a worker has to get ready; it may have to compile the engine
STOP_TIMEOUT = 10.0  # s that a worker has to stop by itself
UNLIMITED = -1  # bytes of a message, because records can be large


class WorkerLostError(WildscavError):
    """The worker that a call was for has ended."""


class WorkerSupervisor:
    """One worker process, restarted whenever it ends."""

    def __init__(self, config: WorkerConfig, log: Log) -> None:
        self.number = config.number  # from 1
        self.generation = 0  # how many processes it has had
        self.seats: Sequence[str] = ()  # addresses at which the seats of its matches are joined
        self.metrics: str | None = None  # URL of its metrics
        self._config, self._log = config, log
        self._process: asyncio.subprocess.Process | None = None
        self._channel: grpc.aio.Channel | None = None
        self._restarter: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Start its process, or raise a UserError; from now on restart it whenever it ends."""
        await self._start_process()
        self._restarter = asyncio.create_task(self._restart_forever())

    async def _start_process(self) -> None:
        self._process = process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "wildscav_server.workers.worker"),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
        )
        try:
            ready = await self._configure(process)
        except BaseException:
            await _kill(process)
            raise
        self.seats, self.metrics = ready.seats, ready.metrics
        self._config = self._config._replace(seats=ready.seats)  # a restarted process uses the same ports
        self.generation += 1
        self._channel = grpc.aio.insecure_channel(
            self._config.arena, options=[("grpc.max_receive_message_length", UNLIMITED)]
        )

    async def _configure(self, process: asyncio.subprocess.Process) -> WorkerReady:
        """Send a process its configuration, and return its answer."""
        if process.stdin is None or process.stdout is None:
            raise RuntimeError("a worker has pipes")
        process.stdin.write(json.dumps(self._config._asdict()).encode() + b"\n")
        line = b""
        try:
            async with asyncio.timeout(START_TIMEOUT):
                line = await process.stdout.readline()
                if not line:
                    raise UserError(
                        f"worker {self.number} did not start: it ended with {await process.wait()}"
                    )
            ready = WorkerReady(**json.loads(line))
        except TimeoutError:
            raise UserError(f"worker {self.number} did not start within {START_TIMEOUT:g} s") from None
        except (ValueError, TypeError):
            answer = line[:100].decode(errors="replace").strip()
            raise UserError(f"worker {self.number} did not start: it answered {answer!r}") from None
        if ready.error:
            raise UserError(ready.error, ready.exit_code)
        return ready

    async def _restart_forever(self) -> None:
        """Restart the process whenever it ends."""
        while self._process is not None:
            code = await self._process.wait()
            self._log.warning("worker_ended", worker=self.number, exit_code=code, fault="platform")
            await asyncio.sleep(RESTART_DELAY)
            await self._close()
            while not await self._try_start():  # noqa: ASYNC110 - this retries, it does not poll
                await asyncio.sleep(RESTART_DELAY)

    async def _try_start(self) -> bool:
        try:
            await self._start_process()
        except (UserError, OSError) as error:  # the caller tries again, because the cause may be temporary
            self._log.warning("worker_did_not_start", worker=self.number, error=str(error))
            return False
        return True

    @property
    def arena(self) -> ArenaStub:
        """The client of its Arena service; a WorkerLostError between one process and the next."""
        if self._channel is None or self._process is None or self._process.returncode is not None:
            raise WorkerLostError(f"worker {self.number} is being restarted")
        return ArenaStub(self._channel)

    async def stop(self) -> None:
        """Stop its process, which cancels its matches."""
        if self._restarter is not None:
            self._restarter.cancel()
        await self._close()
        process = self._process
        if process is None or process.returncode is not None:
            return
        if process.stdin is not None:
            process.stdin.close()
        try:
            async with asyncio.timeout(STOP_TIMEOUT):
                await process.wait()
        except TimeoutError:
            await _kill(process)

    async def _close(self) -> None:
        if self._channel is not None:
            await self._channel.close()
            self._channel = None


async def _kill(process: asyncio.subprocess.Process) -> None:
    with contextlib.suppress(ProcessLookupError):
        process.kill()
    await process.wait()
