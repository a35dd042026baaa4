"""The agents of one match while it is played: starting, watching and ending them together."""

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial

from wildscav_evaluator.bridge.process import bridged
from wildscav_evaluator.model_gateway.gateway import ModelGateway
from wildscav_evaluator.sandbox import Ending, Launch, RunningAgent, Sandbox
from wildscav_evaluator.sandbox.agents.agent_process import AgentProcess
from wildscav_evaluator.sandbox.processor_waits import INTERVAL
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.reports import SeatStatus

METER_TRIES = 40  # to find the processes of a container, which start a moment later


class AgentSpending:
    """What one agent spends on thinking. See ``wildscav_server.thinking.Spending``.

    ``tokens`` returns how many its model has written so far.
    """

    def __init__(self, tokens: Callable[[], int] = lambda: 0) -> None:
        self._tokens = tokens
        self._processor: Callable[[], float] = lambda: 0.0
        self._before = self._ran = 0.0  # s

    def measure(self, processor: Callable[[], float]) -> None:
        """Count from now on what a function says that the agent's threads have run, s."""
        with contextlib.suppress(OSError):
            self._before, self._processor = processor(), processor

    def spent(self) -> tuple[int, float]:
        """Return what it has spent so far."""
        with contextlib.suppress(OSError):  # it has ended
            self._ran = max(self._ran, self._processor() - self._before)
        return self._tokens(), self._ran


def process_time(process: int) -> float:
    """Return how long the threads of a process have run, s, without its children; OSError if it has ended."""
    return time.clock_gettime((~process << 3) | 2)  # as clock_getcpuclockid(3) numbers its clock


class MatchAgents:
    """The processes of a match's agents, by their seats."""

    def __init__(self, hosted: HostedMatch, sandbox: Sandbox, model: ModelGateway | None = None) -> None:
        self._hosted, self._sandbox, self.model = hosted, sandbox, model
        self._running: dict[int, RunningAgent] = {}
        self._watchers: dict[int, asyncio.Task[Ending]] = {}
        self._metering: list[asyncio.Task[None]] = []
        if model is not None:
            self._metering.append(asyncio.create_task(model.watch(self._end_over_budget, hosted.cancel)))

    def _end_over_budget(self, seat: int, reason: str) -> None:
        """End a seat's part in the match, because its model's budget is spent."""
        self._hosted.give_up(seat, reason, SeatStatus.OVER_BUDGET)

    @asynccontextmanager
    async def started(self, launches: Mapping[int, Launch]) -> AsyncIterator[None]:
        """Start agents, by seat, with their model and behind their bridge, for as long as the block lasts."""
        if self.model is not None:
            launches = {
                seat: replace(launch, model=self.model.address(seat)) for seat, launch in launches.items()
            }
        async with bridged(launches, self._hosted) as served:
            for seat, launch in served.items():
                await self.start(seat, launch)
            yield

    async def start(self, seat: int, launch: Launch) -> None:
        """Start the agent of a seat, and watch its process; SandboxError if it cannot be started."""
        agent = await self._sandbox.start(launch)
        self._running[seat] = agent
        self._watchers[seat] = asyncio.create_task(self._watch(seat, agent))
        spending = AgentSpending() if self.model is None else AgentSpending(partial(self.model.written, seat))
        self._hosted.charge_by(seat, spending.spent)
        if isinstance(agent, AgentProcess) and not self._sandbox.isolated:
            spending.measure(partial(process_time, agent.pid))
        self._metering.append(asyncio.create_task(self._measure(seat, agent, spending)))
        self._hosted.launched(seat)

    async def _measure(self, seat: int, agent: RunningAgent, spending: AgentSpending) -> None:
        """Measure an agent's processor time and waits for a processor while it runs, if its sandbox can."""
        for _ in range(METER_TRIES if self._sandbox.isolated else 0):
            meter = await asyncio.to_thread(agent.meter)
            if meter is not None:
                self._hosted.measure(seat, meter)
                spending.measure(meter.ran)
                await meter.run()
            await asyncio.sleep(INTERVAL)

    async def _watch(self, seat: int, agent: RunningAgent) -> Ending:
        """Tell the match when an agent's process is gone, so that the match does not wait for it."""
        ending = await agent.ended()
        if ending.platform_fault and not self._hosted.match.over:
            self._hosted.cancel()  # it will be played again
        elif self.model is not None and self.model.is_over(seat):
            self._end_over_budget(seat, f"its model's budget was spent, and {ending}")
        else:
            self._hosted.give_up(seat, str(ending), status_of(ending))
        return ending

    @property
    def endings(self) -> dict[int, Ending]:
        """The endings of the agents that have ended, by seat."""
        return {seat: watcher.result() for seat, watcher in self._watchers.items() if watcher.done()}

    def overdue(self, seat: int) -> str:
        """Return where the code of a seat's agent was when its time was up, or an empty text if unknown."""
        return self._running[seat].overdue()

    async def leave(self, seconds: float) -> None:
        """Wait until the agents have ended by themselves, at most for the given time in seconds."""
        if self._watchers:  # there are none if robots fill all seats
            await asyncio.wait(self._watchers.values(), timeout=seconds)

    async def stop(self) -> None:
        """Stop the agents that still run."""
        for task in (*self._metering, *self._watchers.values()):
            task.cancel()
        ends = [*(agent.stop() for agent in self._running.values()), *self._watchers.values()]
        await asyncio.gather(*ends, return_exceptions=True)


def status_of(ending: Ending) -> SeatStatus:
    """Return the outcome of a seat whose process ended before the match did."""
    if ending.out_of_memory:
        return SeatStatus.OUT_OF_MEMORY
    return SeatStatus.DISQUALIFIED if ending.limit else SeatStatus.CRASHED
