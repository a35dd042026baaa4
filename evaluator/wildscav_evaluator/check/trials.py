"""The matches that a check plays: one on each track, one with late answers, and one that is cancelled.

All are matches of a suite, with its settings and its limits, and all end early. Nothing that an agent is told
before its first step distinguishes them from the matches that are scored.
"""

import asyncio
import secrets
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from functools import partial
from pathlib import Path
from typing import NamedTuple

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.check import findings
from wildscav_evaluator.check.findings import Finding
from wildscav_evaluator.matches.play import (
    MatchAssignment,
    PlayedMatch,
    agents_at_play,
    play_match,
    prepare_logs,
)
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.sandbox import Ending, Launch, Limits, Promise, RunningAgent, Sandbox
from wildscav_evaluator.sandbox.agents.host_python import socket_path
from wildscav_evaluator.seats import submission_seats
from wildscav_evaluator.submissions.images import lacks_packages, missing_packages
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import EVALUATION_MAPS, Suite
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.time_limits import Clock, TimeBank

STEPS = 600  # after which a match ends: a minute at the usual length of a step
LATE_STEPS = 50  # after which the match with late answers ends
CANCEL_AT = 3  # steps played before the match is cancelled
LEAVING_TIME = 5.0  # s for the agents' processes to end after that
DELAY = 0.4  # s, four times the budget of a step
DELAYED_EVERY = 5  # chunks: every fifth is delayed
CHUNK = 65_536  # bytes at most
TELLING = 1.0  # s between two lines about a match that is being played
Tell = Callable[[str], object]  # is told in one line how far a check is


class Trial(NamedTuple):
    """What a check plays on a track."""

    spec: MatchSpec
    limits: Limits  # of every agent
    seed: SuiteSeed
    model: ModelSettings | None = None  # that agents may ask

    @classmethod
    def of(cls, suite: Suite, track: str, limits: Limits, seed: int | None = None) -> "Trial":
        """Draw a match of a suite.

        Without a seed, it is a fresh match that nobody knows, on a map that no other match is on.
        """
        drawn = secrets.randbits(63) if seed is None else seed
        specs = suite.matches(track, drawn)
        spec = specs[drawn % len(specs)]
        if seed is None and suite.tracks[track].known_maps:
            fresh = spec.map.model_copy(update={"seed": EVALUATION_MAPS | drawn})
            spec = spec.model_copy(update={"map": fresh})
        return cls(spec, limits, SuiteSeed(drawn))

    def asking(self, model: ModelSettings, *, paused: bool) -> "Trial":
        """Return the same match for agents that ask a model, and with a paused clock if that is asked for."""
        changes = {"clock": "paused"} if paused else {}
        return self._replace(model=model, spec=self.spec.model_copy(update=changes))

    def seating(self, submission: Submission, log: Path) -> MatchAssignment:
        """Return the match with a submission in all its seats, and empty logs of its agents."""
        seats = submission_seats(self.spec.seats)
        logs = (log, *(log.with_stem(f"{log.stem}-{number}") for number in range(1, len(seats))))
        prepare_logs(logs)
        seeds = self.seed.private(self.spec, [submission.digest] * len(seats))
        seated = self.spec, (submission,) * len(seats), logs, self.limits
        return MatchAssignment(*seated, seeds=seeds, model=self.model)


class ShortMatch(Match):
    """A match that ends after some steps, whatever its spec says, so that its agents are not told."""

    def __init__(self, steps: int, spec: MatchSpec) -> None:
        super().__init__(spec)
        self._steps = steps

    @property
    def over(self) -> bool:
        """Whether the match has ended."""
        return super().over or self.step_number >= self._steps


class _IdleBank(TimeBank):
    """A bank as agents see it, which pays for nothing: no step waits beyond its budget."""

    def allowed(self, waited: float = 0.0) -> float:
        """Return the budget."""
        del waited
        return self._budget

    def use_up(self) -> None:
        """Note a late answer, and keep what is left, so that agents are told the same as ever."""
        self._used_up = True


class _IdleClock(Clock):
    """The judge's clock with banks that pay for nothing."""

    def bank(self) -> TimeBank:
        """Return such a bank."""
        return _IdleBank(self)


def run_checks(
    submission: Submission,
    sandbox: Sandbox,
    logs: Path,
    trials: Mapping[str, Trial],
    *,
    clock: Clock | None = None,
    tell: Tell = lambda _: None,
) -> Iterator[Finding]:
    """Yield the findings of a check, each as soon as it is known.

    ``trials`` says what to play, by track; the first is also played with late answers, and cancelled.
    ``tell`` is told every second how many steps of which match have been played. WildscavError if the
    platform failed.
    """
    if lacks_packages(submission):
        yield findings.packages(missing_packages(submission))
    with asyncio.Runner() as runner:
        for number, (track, trial) in enumerate(trials.items()):
            used = clock or Clock(longest=trial.limits.wall_clock)
            seating, make = trial.seating(submission, logs / f"{track}.log"), partial(ShortMatch, STEPS)
            begun = _telling(tell, f"match: {track}", STEPS)
            played = runner.run(play_match(seating, sandbox=sandbox, clock=used, make=make, on_start=begun))
            seat, fitted = seating.seats[0], used.fitted(trial.spec)
            judged = list(findings.judge_match(played.seats[seat], fitted, trial.limits, f"match: {track}"))
            judged.append(findings.output(seating.logs[0].stat().st_size, trial.limits))
            yield from (one for one in judged if number == 0 or one.check != "start-up")
            if played.seats[seat].status != "finished":
                return  # an agent that cannot play a match fails the rest for the same reason
            if number == 0:
                yield findings.process_exit(played.endings.get(seat))
        trial = next(iter(trials.values()))
        used = clock or Clock(longest=trial.limits.wall_clock)
        late = runner.run(_delay_replies(trial.seating(submission, logs / "late.log"), sandbox, tell))
        yield findings.lateness(next(iter(late.seats.values())), trial.limits, used)
        cancelled = runner.run(_cancel_match(trial.seating(submission, logs / "cancelled.log"), sandbox))
        yield findings.cancelled_match(cancelled, LEAVING_TIME)


def _telling(tell: Tell, what: str, steps: int) -> Callable[[HostedMatch], None]:
    """Return what follows a match from its start, and tells how many of its steps have been played."""

    async def follow(hosted: HostedMatch) -> None:
        while True:
            most = min(steps, hosted.match.spec.step_limit)
            tell(f"{what}: {hosted.match.step_number} of {most} steps played")
            await asyncio.sleep(TELLING)

    def begin(hosted: HostedMatch) -> None:
        following = asyncio.create_task(follow(hosted))
        hosted.task.add_done_callback(lambda _: following.cancel())

    return begin


async def _delay_replies(seating: MatchAssignment, sandbox: Sandbox, tell: Tell) -> PlayedMatch:
    """Play a match in which steps are played without the agent's answers."""
    async with delayed_replies(sandbox) as late:
        clock, make = _IdleClock(longest=seating.limits.wall_clock), partial(ShortMatch, LATE_STEPS)
        begun = _telling(tell, "late answers", LATE_STEPS)
        return await play_match(seating, sandbox=late, clock=clock, make=make, on_start=begun)


async def _cancel_match(seating: MatchAssignment, sandbox: Sandbox) -> Ending | None:
    """Cancel a match while it is played; return how its first agent's process ended, None if it did not."""
    seat = seating.seats[0]
    async with agents_at_play(seating, sandbox) as (hosted, agents):
        while hosted.match.step_number < CANCEL_AT and seat not in agents.endings and not hosted.task.done():  # noqa: ASYNC110
            await asyncio.sleep(0.005)
        hosted.cancel()
        await agents.leave(LEAVING_TIME)
        return agents.endings.get(seat)


class _DelayingSandbox:
    """A sandbox that runs agents in another sandbox, each behind a delaying proxy.

    The proxy sits between the agent's socket and the match server. While it holds an answer back, the server
    plays the step without it, so the agent's next observation skips steps.
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
