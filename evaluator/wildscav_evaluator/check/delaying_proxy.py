"""A sandbox whose agents are heard too late now and then, however quick they are.

Between the agent's socket and the server stands a relay, which keeps back some of what the agent says. Steps
are played without it meanwhile: its next observation skips them.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path

from wildscav_evaluator.sandbox import Launch, Limits, Promise, RunningAgent, Sandbox
from wildscav_evaluator.sandbox.agents.host_python import socket_path

HELD = 0.2  # s that what an agent says is kept back for
EVERY = 5  # of the pieces in which it arrives
PIECE = 65_536  # bytes at most


class _HardOfHearing:
    """Runs agents as another sandbox does, behind relays.

    Args:
        sandbox: The other one.
        relays: Closes them.
    """

    def __init__(self, sandbox: Sandbox, relays: AsyncExitStack) -> None:
        self._sandbox, self._relays = sandbox, relays
        self.name, self.isolated = sandbox.name, sandbox.isolated

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        return self._sandbox.promises(limits)

    async def start(self, launch: Launch) -> RunningAgent:
        path = socket_path(launch.address)
        moved = path.rename(path.with_name("server.sock"))
        await self._relays.enter_async_context(_relay(path, moved))
        return await self._sandbox.start(launch)


@asynccontextmanager
async def heard_late(sandbox: Sandbox) -> AsyncIterator[Sandbox]:
    """Return a sandbox like another one, whose agents are heard late until the end of the context."""
    async with AsyncExitStack() as relays:
        yield _HardOfHearing(sandbox, relays)


@asynccontextmanager
async def _relay(path: Path, server_path: Path) -> AsyncIterator[None]:
    """Listen at a path, and pass on what comes there to the server's socket, and back."""
    passing: set[asyncio.Task[None]] = set()

    async def serve(near: asyncio.StreamReader, back: asyncio.StreamWriter) -> None:
        far, forth = await asyncio.open_unix_connection(server_path)
        for way in (_pass(near, forth, HELD), _pass(far, back, 0.0)):
            task = asyncio.create_task(way)
            passing.add(task)
            task.add_done_callback(passing.discard)

    server = await asyncio.start_unix_server(serve, path)
    try:
        yield
    finally:
        server.close()
        for task in passing:
            task.cancel()


async def _pass(source: asyncio.StreamReader, sink: asyncio.StreamWriter, held: float) -> None:
    """Pass bytes on until their source ends, some of them later than others."""
    pieces = 0
    try:
        while piece := await source.read(PIECE):
            pieces += 1
            if pieces % EVERY == 0:
                await asyncio.sleep(held)
            sink.write(piece)
            await sink.drain()
    except ConnectionError:
        pass  # whoever was to hear it has gone, as its own side will say
    finally:
        sink.close()
