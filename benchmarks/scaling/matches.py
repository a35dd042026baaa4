"""Simultaneous matches on one shared server."""

import asyncio
import os
import tempfile
import time
from pathlib import Path

import grpc
from benchmarks.report import children_of, processor_time
from benchmarks.services.server import match_spec, start_agent

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.matches import decode_seat_address
from wildscav_engine.parallel.threads import cores
from wildscav_server.workers.shared_server import SharedServer

LONG = 36_000.0  # s of a match: no match ends meanwhile
BEGUN = 20  # steps, after which a match counts as running
AT_ONCE = 4  # agents that start at the same time
SECONDS = 5.0


def matches(count: int) -> dict[str, float]:
    """Measure matches of one agent each, whose agents are processes on the same machine."""
    with tempfile.TemporaryDirectory() as folder:
        return asyncio.run(_measure(Path(folder), count))


async def _measure(folder: Path, count: int) -> dict[str, float]:
    server = SharedServer(cores())
    (address,) = await server.start([f"unix:{folder}/shared.sock"])
    spec = match_spec(1).model_copy(update={"time_limit": LONG}).model_dump_json()
    agents: list[asyncio.subprocess.Process] = []
    async with grpc.aio.insecure_channel(address) as channel:
        arena = ArenaStub(channel)
        try:
            hosted: list[str] = []
            while len(hosted) < count:
                one = await arena.HostMatch(HostMatchRequest(spec_json=spec))
                hosted.append(one.match_id)
                agents.append(await start_agent(decode_seat_address(one, address), one.seat_tokens[0]))
                if len(hosted) % AT_ONCE == 0:  # more than these would take too long to join
                    await _begun(arena, hosted)
            return await _rates(arena, hosted)
        finally:
            for agent in agents:
                agent.kill()
                await agent.wait()
            await server.stop()


async def _rates(arena: ArenaStub, hosted: list[str]) -> dict[str, float]:
    """Return the steps a second of all matches and of the slowest one, and the server's time for a step."""
    before = await _begun(arena, hosted)
    used, started = _workers_time(), time.perf_counter()
    await asyncio.sleep(SECONDS)
    after = await _steps(arena, hosted)
    used, seconds = _workers_time() - used, time.perf_counter() - started
    played = [now - then for now, then in zip(after, before, strict=True)]
    return {
        "steps_a_second": sum(played) / seconds,
        "of_the_slowest": min(played) / seconds,
        "server_microseconds": 1e6 * used / sum(played),
    }


async def _begun(arena: ArenaStub, hosted: list[str]) -> list[int]:
    """Wait until all matches are being played; return how many steps each has played."""
    while min(steps := await _steps(arena, hosted)) < BEGUN:  # noqa: ASYNC110 - in other processes
        await asyncio.sleep(0.2)
    return steps


async def _steps(arena: ArenaStub, hosted: list[str]) -> list[int]:
    """Return how many steps each match has played."""
    states = [await arena.GetMatch(GetMatchRequest(match_id=one)) for one in hosted]
    if ended := [state for state in states if state.state > GetMatchResponse.STATE_PLAYING]:
        raise RuntimeError(f"a match ended: {ended[0].error} {ended[0].conduct}")
    return [state.steps for state in states]


def _workers_time() -> float:
    """Return the processor time that the server's workers have used, s."""
    return sum(map(processor_time, children_of(os.getpid(), b"wildscav_server.workers.worker")))
