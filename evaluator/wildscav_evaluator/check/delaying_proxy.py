"""A proxy that delays some of what an agent sends, to test how the agent copes with late answers.

The proxy sits between the agent's socket and the match server. While it holds an answer back, the server
plays the step without it, so the agent's next observation skips steps.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path

from wildscav_evaluator.sandbox import Launch, Limits, Promise, RunningAgent, Sandbox
from wildscav_evaluator.sandbox.agents.host_python import socket_path

DELAY = 0.4  # s, four times the budget of a step
DELAYED_EVERY = 5  # chunks: every fifth is delayed
CHUNK = 65_536  # bytes at most


class _DelayingSandbox:
    """A sandbox that runs agents in another sandbox, each behind a delaying proxy.

    Args:
        sandbox: The sandbox that runs the agents.
        proxies: The stack that closes the proxies when it exits.
    """

    def __init__(self, sandbox: Sandbox, proxies: AsyncExitStack) -> None:
        self._sandbox, self._proxies = sandbox, proxies
        self.name, self.isolated = sandbox.name, sandbox.isolated
        self.runs_images = sandbox.runs_images

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        return self._sandbox.promises(limits)

    async def start(self, launch: Launch) -> RunningAgent:
        path = socket_path(launch.address)
        moved = path.rename(path.with_name("server.sock"))
        await self._proxies.enter_async_context(_delaying_proxy(path, moved))
        return await self._sandbox.start(launch)


@asynccontextmanager
async def delayed_replies(sandbox: Sandbox) -> AsyncIterator[Sandbox]:
    """Yield a sandbox that runs agents like the given one, but delays their answers."""
    async with AsyncExitStack() as proxies:
        yield _DelayingSandbox(sandbox, proxies)


@asynccontextmanager
async def _delaying_proxy(path: Path, server_path: Path) -> AsyncIterator[None]:
    """Listen at a path, and forward data between its connections and the server's socket."""
    forwarding: set[asyncio.Task[None]] = set()

    async def serve(from_agent: asyncio.StreamReader, to_agent: asyncio.StreamWriter) -> None:
        from_server, to_server = await asyncio.open_unix_connection(server_path)
        for direction in (_forward(from_agent, to_server, DELAY), _forward(from_server, to_agent, 0.0)):
            task = asyncio.create_task(direction)
            forwarding.add(task)
            task.add_done_callback(forwarding.discard)

    server = await asyncio.start_unix_server(serve, path)
    try:
        yield
    finally:
        server.close()
        for task in forwarding:
            task.cancel()


async def _forward(source: asyncio.StreamReader, sink: asyncio.StreamWriter, delay: float) -> None:
    """Forward bytes until the source ends; wait ``delay`` seconds before every fifth chunk."""
    chunks = 0
    try:
        while chunk := await source.read(CHUNK):
            chunks += 1
            if chunks % DELAYED_EVERY == 0:
                await asyncio.sleep(delay)
            sink.write(chunk)
            await sink.drain()
    except ConnectionError:
        pass  # the receiver is gone; its own side reports that
    finally:
        sink.close()
