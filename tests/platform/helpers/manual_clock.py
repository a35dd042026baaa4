"""A server whose clock stands still until a test sets it forward.

However busy the machine is, no seat is late unless the test says so, and every time is exact.
"""

import asyncio
import threading
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.platform.helpers.seats import HandPlayed, Result, Ruling, Served, test_of

from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.lockstep import LAG
from wildscav_server.hosting.precompile import precompile
from wildscav_server.match_server import MatchServer

# s; a power of two, so that times are exact. The server takes longer hops for its own delay.
HOP = 2.0**-8
assert HOP < LAG
HANGS = 300.0  # s of real time after which a test has failed


class HandSetLoop(asyncio.SelectorEventLoop):
    """An event loop whose time passes only by ``pass_time``, in multiples of ``HOP``."""

    def __init__(self) -> None:
        super().__init__()
        self.now = 1000.0  # s

    def time(self) -> float:
        return self.now

    async def pass_time(self, seconds: float) -> None:
        """Set the clock forward, and let everything happen that is due on the way; by 0, what is due now."""
        await asyncio.sleep(0)
        end = self.now + seconds
        while self.now < end:
            self.now += HOP
            for _ in range(3):  # a timer, the task that it wakes, and whatever that one tells
                await asyncio.sleep(0)


def serving_by_hand(
    tmp_path: Path, test: Callable[[MatchServer, str, HandSetLoop], Awaitable[Result]], **options: Any
) -> Result:
    """Run a test in a loop whose clock it sets, with a server on a unix socket."""

    async def run() -> Result:
        server = MatchServer(**options)
        (address,) = await server.start([f"unix:{tmp_path / 'match.sock'}"])
        try:
            return await test(server, address, loop)
        finally:
            await server.stop()

    precompile()  # compiling is not what is tested
    loop = HandSetLoop()
    with asyncio.Runner(loop_factory=lambda: loop) as runner:
        runner.get_loop()
        watchdog = threading.Timer(HANGS, lambda: loop.call_soon_threadsafe(_give_up, loop))
        watchdog.start()
        try:
            return runner.run(run())
        finally:
            watchdog.cancel()


@dataclass(frozen=True)
class ServedByHand(Served):
    """A server whose clock a test sets, too."""

    clock: HandSetLoop

    async def pass_time(self, seconds: float) -> None:
        """Set the clock forward."""
        await self.clock.pass_time(seconds)


def with_server_by_hand(ruling: Ruling) -> Callable[..., None]:
    """Make a test of a coroutine whose first argument is ``ServedByHand``; others are fixtures."""
    return test_of(
        lambda folder, play: serving_by_hand(folder, lambda *own: play(ServedByHand(*own))), ruling
    )


def _give_up(loop: HandSetLoop) -> None:
    for task in asyncio.all_tasks(loop):
        task.cancel(f"nothing happened for {HANGS:g} s")


async def has_answered(hosted: HostedMatch, seat: int, step: int) -> None:
    """Wait until the server has a seat's answer to a step."""
    while hosted.seats[seat].conduct.steps_played <= step:  # noqa: ASYNC110
        await asyncio.sleep(0)  # the loop polls for real events in between


async def answer(seat: HandPlayed, hosted: HostedMatch, number: int, **action: float) -> int:
    """Answer the next observation, wait until the answer has arrived, and return the observation's step."""
    played = hosted.seats[number].conduct.steps_played
    step = (await seat.read()).observation.step
    await seat.act(step, **action)
    await has_answered(hosted, number, played)
    return step
