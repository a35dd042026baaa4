"""What a call of a tool over MCP takes beyond the steps that it plays.

The same call is made of the seat itself, of the desk behind the protocol, and by the official client. A tool
of one step is called, so that hardly anything but the call remains. Clients and server share this process,
except over standard input and output.
"""

import asyncio
import re
import statistics
import sys
import tempfile
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, NamedTuple

import typer
from benchmarks.report import Figure, JsonFile, publish
from mcp import Client, StdioServerParameters
from mcp.client.stdio import stdio_client
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
MATCH = {"map": 103, "time_limit": 600.0}
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


def handle_in(text: str) -> str:
    """Return the handle of a seat in the answer of ``start_match``."""
    (handle,) = re.findall(r"^seat: (\S+)$", text, re.MULTILINE)
    return str(handle)


async def calls_here(folder: Path) -> list[Figure]:
    """Measure calls of a server in this process."""
    ready = asyncio.get_running_loop().create_future()
    ready.set_result(None)
    async with serving(folder, Bounds()) as matches:
        desk = Desk(matches, ready, None)
        handle = handle_in((await desk.answer("start_match", MATCH)).text)
        _, seat = matches.seat(handle)
        given: dict[str, Any] = {"seat": handle, **STEP}
        sockets = bind("127.0.0.1:0")
        web = asyncio.create_task(serve_http(desk, sockets, None, ["127.0.0.1"]))
        url = f"http://127.0.0.1:{sockets[0].getsockname()[1]}{PATH}"
        async with Client(make_server(desk)) as near, Client(streamable_http_client(url)) as far:
            calls: dict[str, Call] = {
                "the seat itself": lambda: asyncio.to_thread(seat.words.call, "wait_until", STEP),
                "the desk": lambda: desk.answer("wait_until", given),
                "a client in the process": lambda: near.call_tool("wait_until", given),
                "a client over HTTP": lambda: far.call_tool("wait_until", given),
            }
            figures = [await figure(name, call) for name, call in calls.items()]
        web.cancel()
        await asyncio.gather(web, return_exceptions=True)
    return figures


async def calls_of_command(folder: Path) -> list[Figure]:
    """Measure calls of the command, over its standard input and output."""
    wildscav = Path(sys.executable).parent / "wildscav"
    server = StdioServerParameters(command=str(wildscav), args=["mcp", "--out", str(folder)])
    async with Client(stdio_client(server)) as client:
        begun = await client.call_tool("start_match", MATCH)
        given = {"seat": handle_in(begun.content[0].text), **STEP}
        return [await figure("a client over stdio, its half", lambda: client.call_tool("wait_until", given))]


async def figure(name: str, call: Call) -> Figure:
    """Measure a call."""
    took = await times_of(call)
    return Figure(
        name, took.processor, "ms", f"median to the answer {took.median:.1f}, least {took.least:.1f}"
    )


def main(json_file: JsonFile = None) -> None:
    """Measure how long calls over MCP take."""
    precompile(parse_sensors(sensors()).values())
    with tempfile.TemporaryDirectory() as folder:
        figures = asyncio.run(calls_here(Path(folder))) + asyncio.run(calls_of_command(Path(folder)))
        publish("a call of one step over MCP, by processor time", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
