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
from wildscav_evaluator.bridge.orders import Order
from wildscav_evaluator.sandbox.base import Launch
from wildscav_server.hosting.hosted_match import HostedMatch

SOCKET = "bridge.sock"  # beside the match's
BACKLOG = 16  # connections that wait to be accepted
END_TIME = 3.0  # s for the process to end


class BridgeError(WildscavError):
    """The bridge failed, which is the platform's fault."""


@asynccontextmanager
async def bridged(launches: Mapping[int, Launch], hosted: HostedMatch) -> AsyncIterator[dict[int, Launch]]:
    """Run the bridge of a match for as long as the block lasts; yield what its agents are started with.

    An agent that plays by words or keys gets a socket and a token of the bridge in place of the match's.

    Args:
        launches: The agents, by seat.
        hosted: Their match, which is cancelled if the bridge fails.

    Raises:
        BridgeError: The bridge failed.
        OSError: It could not be started.
    """
    own = {seat: launch for seat, launch in launches.items() if launch.interface != "numbers"}
    if not own:
        yield dict(launches)
        return
    with ExitStack() as sockets:
        orders, behind = [], {}
        for seat, launch in own.items():
            listener = sockets.enter_context(socket.socket(socket.AF_UNIX))
            address = f"{launch.address.rpartition('/')[0]}/{SOCKET}"
            listener.bind(address.removeprefix("unix:"))
            listener.listen(BACKLOG)
            behind[seat] = replace(launch, address=address, token=secrets.token_urlsafe())
            names = hosted.names
            orders.append(
                Order(
                    interface=launch.interface,
                    socket=listener.fileno(),
                    token=behind[seat].token,
                    address=launch.address,
                    match_token=launch.token,
                    names=names,
                )
            )
        process = await _start(orders)
    watching = asyncio.create_task(_watch(process, hosted))
    try:
        yield {**launches, **behind}
    finally:
        fault = await _end(process, watching)
        if fault:
            raise BridgeError(f"the bridge to seats of words and keys failed: {fault}")


async def _start(orders: list[Order]) -> asyncio.subprocess.Process:
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "wildscav_evaluator.bridge"),
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
    """End the bridge, and return why it failed, in a line; an empty text if it did not."""
    if process.stdin is not None:
        process.stdin.close()
    done, _ = await asyncio.wait({watching}, timeout=END_TIME)
    if not done:
        process.kill()
    said = (await watching).strip()
    if done and process.returncode == 0:
        return ""
    return said.rpartition("\n")[2] or f"it ended with code {process.returncode}"
