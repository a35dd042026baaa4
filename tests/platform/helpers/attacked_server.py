"""A server under attack, and the process that its attackers are in."""

import asyncio
import contextlib
import functools
import multiprocessing
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from tests.platform.helpers.hostile_client import END, Attacker, Move
from tests.platform.helpers.seats import connected, ended, host, small_spec, start_agent

from wildscav_server.hosting.hosted_match import HostedMatch, MatchCancelledError
from wildscav_server.hosting.reports import SeatReport
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

Result = TypeVar("Result")
OUTCOMES = frozenset({"finished", "timed_out", "crashed", "protocol_error", "never_joined"})
HASTY = Clock(step_budget=0.02, time_bank=0.02, join_timeout=0.1)
STEPS = 3
HONEST = 60.0  # s of game time of the honest agent's matches: one that went on would keep all its steps
ROUNDS_KEPT = 100  # of attacks that one process makes: gRPC keeps some of each call that is cancelled unread


class Raid(NamedTuple):
    """What one attacker is to do."""

    tokens: dict[int, str]
    moves: Sequence[Move]


def make_raids(address: str, raids: Sequence[Raid]) -> list[str]:
    """Let clients attack a match of their own each, all at once; return how their streams ended."""
    return _runner().run(_make_raids(address, raids))


@functools.cache
def _runner() -> asyncio.Runner:
    return asyncio.Runner()


async def _make_raids(address: str, raids: Sequence[Raid]) -> list[str]:
    async def make(raid: Raid) -> str:
        async with connected(address) as seat:
            return await Attacker(seat, raid.tokens, address).make(raid.moves)

    async with asyncio.timeout(2 * END):
        return await asyncio.gather(*map(make, raids))


class Siege:
    """A server under attack, at which honest agents play match after match in processes of their own.

    The attackers are in another one, so that what this process keeps is what the server keeps.
    """

    def __init__(self, folder: Path) -> None:
        self._attackers = ProcessPoolExecutor(
            1, multiprocessing.get_context("spawn"), max_tasks_per_child=ROUNDS_KEPT
        )
        self._reports: list[SeatReport] = []  # of the honest agents that have finished
        self._over = False
        self._runner = asyncio.Runner()
        self._runner.run(self._begin(folder))

    async def _begin(self, folder: Path) -> None:
        self.server = MatchServer()
        (self.address,) = await self.server.start([f"unix:{folder / 'match.sock'}"])
        self._honest = await host(self.server, small_spec("navigation", seconds=HONEST))
        self._playing = asyncio.create_task(self._play_honestly())
        while self._honest.match.step_number < 10:  # noqa: ASYNC110
            await asyncio.sleep(0.01)

    async def _play_honestly(self) -> None:
        while not self._over:
            agent = await start_agent("Walker", self.address, self._honest.tokens[0])
            try:
                outcome = await self._honest.finished()
                self._reports.append(outcome.seats[0])
                self._honest = await host(self.server, small_spec("navigation", seconds=HONEST))
            finally:
                how = await ended(agent)
            assert how == (0, ""), how

    def meanwhile(self, function: Callable[..., Result], *arguments: Any) -> Result:
        """Return what a function returns, while the honest agents play on."""
        return self._runner.run(asyncio.to_thread(function, *arguments))

    def attack(self, attacks: Sequence[Sequence[Move]]) -> list[str]:
        """Let clients attack a match of their own each, all at once; return how their streams ended."""
        return self._runner.run(self._attack(attacks))

    async def _attack(self, attacks: Sequence[Sequence[Move]]) -> list[str]:
        spec = small_spec(seats=2, seconds=STEPS / 10)
        matches = [await host(self.server, spec, clock=HASTY, starting=True) for _ in attacks]
        raids = [Raid(hosted.tokens, moves) for hosted, moves in zip(matches, attacks, strict=True)]
        for hosted in matches:
            for seat in hosted.tokens:
                hosted.launched(seat)
        loop = asyncio.get_running_loop()
        endings = await loop.run_in_executor(self._attackers, make_raids, self.address, raids)
        await asyncio.gather(*map(see_played, matches))
        return endings

    def end(self) -> list[SeatReport]:
        """End the siege; return how the honest agents fared."""
        try:
            return self._runner.run(self._end())
        finally:
            self._runner.close()
            self._attackers.shutdown()

    async def _end(self) -> list[SeatReport]:
        self._reports.append(self._honest.seats[0].report())
        assert not self._playing.done()
        async with asyncio.timeout(20):  # whoever is refused waits a little for it
            while len(server_tasks()) > 12:  # noqa: ASYNC110
                await asyncio.sleep(0.1)
        self._over = True
        self._honest.cancel()
        with contextlib.suppress(MatchCancelledError):
            await self._playing
        await self.server.stop()
        return self._reports


async def see_played(hosted: HostedMatch) -> None:
    """See that an attacked match was played to its end, and that each seat got an outcome."""
    outcome = await hosted.finished()
    assert outcome.match.step_number == STEPS
    assert {report.status.value for report in outcome.seats.values()} <= OUTCOMES


def server_tasks() -> list[str]:
    """Return what the tasks of this process do."""
    return [getattr(task.get_coro(), "__qualname__", "") for task in asyncio.all_tasks()]


def memory() -> int:
    """Return the resident memory of this process, bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
