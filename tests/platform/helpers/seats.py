"""Hosts matches for tests, with agents in real processes or seats played by hand."""

import asyncio
import inspect
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from functools import partial, update_wrapper
from pathlib import Path
from typing import Any, TypeVar

import grpc

from wildscav.proto import PROTOCOL_VERSION
from wildscav.proto.match_pb2 import Action, ClientMessage, Join, ServerMessage
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.precompile import precompile
from wildscav_server.match_server import MatchServer

# Else all channels of a process share one, and the streams of those that leave without reading crowd it.
OWN_CONNECTION = [("grpc.use_local_subchannel_pool", 1)]
AGENTS = Path(__file__).parent / "agents"
Result = TypeVar("Result")


def small_spec(track: str = "gathering", seats: int = 1, seconds: float = 2.0, **spec: Any) -> MatchSpec:
    """A match on a small bare map; ten steps are a second."""
    small = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=5)
    filled = spec.pop("filled_by", ("submission",) * seats)
    return MatchSpec(track=track, map=small, seed=7, seats=filled, time_limit=seconds, **spec)


async def host(server: MatchServer, spec: MatchSpec, **options: Any) -> HostedMatch:
    """Host a match with the names of its seats made up."""
    return await server.host(spec, names=[f"seat {seat}" for seat in range(len(spec.seats))], **options)


def serving(
    tmp_path: Path,
    test: Callable[[MatchServer, str], Awaitable[Result]],
    patience: float = 300.0,
    **options: Any,
) -> Result:
    """Run a test in a loop with a server on a unix socket."""

    async def run() -> Result:
        server = MatchServer(**options)
        (address,) = await server.start([f"unix:{tmp_path / 'match.sock'}"])
        try:
            async with asyncio.timeout(patience):
                return await test(server, address)
        finally:
            await server.stop()

    precompile()  # compiling is not what is tested
    return asyncio.run(run())


@dataclass(frozen=True)
class Served:
    """A server, and the address at which its seats are joined."""

    server: MatchServer
    address: str

    async def host(self, spec: MatchSpec, **options: Any) -> HostedMatch:
        """Host a match with the names of its seats made up."""
        return await host(self.server, spec, **options)

    def seated(self, hosted: HostedMatch) -> "AbstractAsyncContextManager[list[HandPlayed]]":
        """See ``seated``."""
        return seated(self.address, hosted)


Ruling = Callable[..., Awaitable[None]]


def with_server_of(**options: Any) -> Callable[[Ruling], Callable[..., None]]:
    """Return a decorator that makes a test of a coroutine with ``Served`` and fixtures as arguments."""
    return partial(test_of, lambda folder, play: serving(folder, lambda *own: play(Served(*own)), **options))


def test_of(run: Callable[[Path, Ruling], None], ruling: Ruling) -> Callable[..., None]:
    """Return the test that runs a coroutine; ``run`` calls it with its first argument."""
    _, *others = inspect.signature(ruling).parameters.values()
    folder = inspect.Parameter("tmp_path", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    wanted = {one.name: one for one in others}

    def test(tmp_path: Path, **fixtures: Any) -> None:
        given = fixtures | {name: tmp_path for name in wanted if name == folder.name}
        run(tmp_path, partial(ruling, **given))

    update_wrapper(test, ruling)
    del test.__wrapped__  # type: ignore[attr-defined] # else pytest takes the fixtures of the coroutine
    test.__signature__ = inspect.Signature([*({folder.name: folder} | wanted).values()])  # type: ignore[attr-defined]
    return test


with_server = with_server_of()


async def start_agent(
    name: str, address: str, token: str, folder: Path = AGENTS
) -> asyncio.subprocess.Process:
    """Start an agent in a process of its own."""
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "wildscav.sdk", name if ":" in name else f"agents:{name}"),
        cwd=folder,
        env={**os.environ, "WILDSCAV_ADDRESS": address, "WILDSCAV_TOKEN": token},
        stderr=asyncio.subprocess.PIPE,
    )


async def ended(agent: asyncio.subprocess.Process) -> tuple[int | None, str]:
    """Wait for an agent's process; return its exit code and what it said on stderr."""
    _, errors = await agent.communicate()
    return agent.returncode, errors.decode()


class HandPlayed:
    """A seat's stream, message by message."""

    def __init__(self, call: Any) -> None:
        self.call = call

    async def send(self, message: ClientMessage | bytes) -> None:
        if isinstance(message, ClientMessage):
            message = message.SerializeToString()
        await self.call.write(message)

    async def join(self, token: str, version: int = PROTOCOL_VERSION) -> ServerMessage:
        await self.send(ClientMessage(join=Join(token=token, protocol_version=version)))
        return await self.read()

    async def read(self) -> ServerMessage:
        message = await self.call.read()
        assert isinstance(message, ServerMessage)
        return message

    async def read_out(self) -> None:
        """Read to the end of the stream and answer nothing."""
        while await self.call.read() is not grpc.aio.EOF:
            pass

    async def act(self, step: int, **fields: Any) -> None:
        await self.send(ClientMessage(action=Action(step=step, **fields)))

    async def play_out(self, **fields: Any) -> ServerMessage:
        """Answer every observation in the same way; return the last message."""
        while (message := await self.read()).HasField("observation"):
            await self.act(message.observation.step, **fields)
        return message


@asynccontextmanager
async def connected(address: str) -> AsyncIterator[HandPlayed]:
    """Open a stream that says nothing yet, on a connection of its own, as other processes have it."""
    async with grpc.aio.insecure_channel(address, options=OWN_CONNECTION) as channel:
        play = channel.stream_stream(
            "/wildscav.match.v1.Match/Play", response_deserializer=ServerMessage.FromString
        )
        yield HandPlayed(play())


@asynccontextmanager
async def seated(address: str, hosted: HostedMatch) -> AsyncIterator[list[HandPlayed]]:
    """Take all seats of a match, each from a connection of its own."""
    async with AsyncExitStack() as stack:
        seats = []
        for token in hosted.tokens.values():
            seats.append(await stack.enter_async_context(connected(address)))
            await seats[-1].join(token)
        yield seats
