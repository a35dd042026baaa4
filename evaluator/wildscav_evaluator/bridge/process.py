"""Starts the bridge of a match, puts it between the match and its agents, and tells whether it failed."""

import asyncio
import json
import secrets
import socket
import sys
from collections.abc import AsyncIterator, Mapping
from contextlib import ExitStack, asynccontextmanager
from dataclasses import replace

from wildscav.errors import WildscavError
from wildscav_evaluator.bridge.desk import Order
from wildscav_evaluator.sandbox.base import Launch
from wildscav_server.hosting.hosted_match import HostedMatch

SOCKET = "bridge.sock"  # beside the match's
BACKLOG = 16  # connections that wait to be accepted
END_TIME = 3.0  # s for the process to end, before it is killed
COMMAND = sys.executable, "-m", "wildscav_evaluator.bridge"


class BridgeError(WildscavError):
    """The bridge failed, which is the platform's fault."""


@asynccontextmanager
async def bridged(launches: Mapping[int, Launch], hosted: HostedMatch) -> AsyncIterator[dict[int, Launch]]:
    """Run the bridge of a match for as long as the block lasts; yield what its agents are started with.

    An agent that plays by words or keys gets a socket and a token of the bridge in place of the match's.

    Raises:
        BridgeError: The bridge failed.
        OSError: It could not be started.
    """
    bridged_launches = {seat: launch for seat, launch in launches.items() if launch.interface != "numbers"}
    if not bridged_launches:
        yield dict(launches)
        return
    with ExitStack() as sockets:
        orders, served = [], {}
        for seat, launch in bridged_launches.items():
            listener = sockets.enter_context(socket.socket(socket.AF_UNIX))
            address = f"{launch.address.rpartition('/')[0]}/{SOCKET}"
            listener.bind(address.removeprefix("unix:"))
            listener.listen(BACKLOG)
            served[seat] = replace(launch, address=address, token=secrets.token_urlsafe())
            orders.append(
                Order(
                    interface=launch.interface,
                    socket=listener.fileno(),
                    token=served[seat].token,
                    address=launch.address,
                    match_token=launch.token,
                    names=hosted.names,
                )
            )
        process = await _start(orders)
    watching = asyncio.create_task(_watch(process, hosted))
    is_cancelled = False
    try:
        yield {**launches, **served}
    except asyncio.CancelledError:
        is_cancelled = True
        raise
    finally:
        fault = await _end(process, watching)
        if fault and not is_cancelled:
            raise BridgeError(f"the bridge to seats of words and keys failed: {fault}")


async def _start(orders: list[Order]) -> asyncio.subprocess.Process:
    process = await asyncio.create_subprocess_exec(
        *COMMAND,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.PIPE,
        pass_fds=[order.socket for order in orders],
        start_new_session=True,  # so that Ctrl-C ends it with its match
    )
    if process.stdin is None:
        raise RuntimeError("the standard input of the bridge is a pipe")
    process.stdin.write(json.dumps([order._asdict() for order in orders]).encode() + b"\n")
    return process


async def _watch(process: asyncio.subprocess.Process, hosted: HostedMatch) -> str:
    """Wait for the end of the bridge, and return what it printed. If the match needs it, cancel the match."""
    said = b"" if process.stderr is None else await process.stderr.read()
    await process.wait()
    hosted.cancel()  # does nothing after the match's end
    return said.decode(errors="replace")


async def _end(process: asyncio.subprocess.Process, watching: "asyncio.Task[str]") -> str:
    """End the bridge, and return in a line why it failed; an empty text if it did not, or only took long."""
    if process.stdin is not None:
        process.stdin.close()
    ended_by_itself, _ = await asyncio.wait({watching}, timeout=END_TIME)
    if not ended_by_itself:
        process.kill()
    said = (await watching).strip()
    if not ended_by_itself or process.returncode == 0:
        return ""
    return said.rpartition("\n")[2] or f"it ended with code {process.returncode}"
