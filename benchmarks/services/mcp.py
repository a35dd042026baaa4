"""What a call of a tool over MCP takes beyond the steps that it plays, over HTTP and within one process.

The same call is made of the seat itself, of the desk behind the protocol, and by the official client. A tool
of one step is called, so that hardly anything but the call remains. Clients and server share this process.
"""

import asyncio
import re
import statistics
import tempfile
import time
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import typer
from benchmarks.report import Figure, JsonFile, publish
from mcp import Client
from mcp.client.streamable_http import streamable_http_client

from wildscav_engine.sensors import parse_sensors
from wildscav_language.mcp_server.desk import Desk
from wildscav_language.mcp_server.matches import Bounds, serving
from wildscav_language.mcp_server.protocol import PATH, make_server, serve_http
from wildscav_language.senses import sensors
from wildscav_server.endpoints.addresses import bind
from wildscav_server.hosting.precompile import precompile

CALLS, ROUNDS = 20, 5
STEP = {"seconds": 0.1}  # of one step
Call = Callable[[], Awaitable[object]]


class Times(NamedTuple):
    """How long a call takes, ms."""

    processor: float  # the least of several rounds
    median: float
    least: float


async def times_of(call: Call) -> Times:
    """Return how long a call takes."""
    times, processor = [], []
    for _ in range(ROUNDS):
        used = time.process_time()
        for _ in range(CALLS):
            began = time.perf_counter()
            await call()
            times.append((time.perf_counter() - began) * 1e3)
        processor.append((time.process_time() - used) / CALLS * 1e3)
    return Times(min(processor), statistics.median(times), min(times))


async def measure(folder: Path) -> list[Figure]:
    """Measure all kinds of calls in one match each."""
    ready = asyncio.get_running_loop().create_future()
    ready.set_result(None)
    figures = []
    async with serving(folder, Bounds()) as matches:
        desk = Desk(matches, ready, None)
        answer = await desk.answer("start_match", {"map": 103, "time_limit": 600.0})
        handle = re.findall(r"^seat: (\S+)$", answer.text, re.MULTILINE)[0]
        _, seat = matches.seat(handle)
        given: Mapping[str, Any] = {"seat": handle, **STEP}
        sockets = bind("127.0.0.1:0")
        web = asyncio.create_task(serve_http(desk, sockets, None, is_public=False))
        url = f"http://127.0.0.1:{sockets[0].getsockname()[1]}{PATH}"
        async with Client(make_server(desk)) as near, Client(streamable_http_client(url)) as far:
            calls: dict[str, Call] = {
                "the seat itself, a step included": lambda: asyncio.to_thread(
                    seat.words.call, "wait_until", STEP
                ),
                "at the desk": lambda: desk.answer("wait_until", given),
                "by a client in the process": lambda: near.call_tool("wait_until", dict(given)),
                "by a client over HTTP": lambda: far.call_tool("wait_until", dict(given)),
                "observe, by a client over HTTP": lambda: far.call_tool("observe", {"seat": handle}),
            }
            for name, call in calls.items():
                took = await times_of(call)
                note = f"of a processor; from call to answer {took.median:.1f}, at least {took.least:.1f}"
                figures.append(Figure(name, took.processor, "ms", note))
        web.cancel()
        await asyncio.gather(web, return_exceptions=True)
    return figures


def main(json_file: JsonFile = None) -> None:
    """Measure how long calls over MCP take."""
    precompile(parse_sensors(sensors()).values())
    with tempfile.TemporaryDirectory() as folder:
        publish("calls over MCP", asyncio.run(measure(Path(folder))), json_file)


if __name__ == "__main__":
    typer.run(main)
