"""The matches that a check plays: one on each track, one with late answers, and one that is cancelled."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

from wildscav.server import Clock, HostedMatch, MatchServer
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.check import findings
from wildscav_evaluator.check.delaying_proxy import delayed_replies
from wildscav_evaluator.check.findings import Finding
from wildscav_evaluator.matches.play import (
    PlayedMatch,
    Seating,
    launch_for,
    play_match,
    prepare_logs,
    socket_folders,
)
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, Ending, Sandbox
from wildscav_evaluator.submissions.images import lacks_packages
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.suite import suite

TIGHT_CLOCK = Clock(step_budget=0.05, time_bank=0.0)  # a quarter of the proxy's delay
CANCEL_AT = 3  # steps played before the match is cancelled
LEAVING_TIME = 5.0  # s for the agent's process to end after that
LIMITS = DEFAULT_LIMITS


def run_checks(
    submission: Submission, sandbox: Sandbox, logs: Path, *, clock: Clock | None = None
) -> Iterator[Finding]:
    """Yield the findings of a check, each as soon as it is known.

    Args:
        submission: The submission, which was loaded and so has valid files.
        sandbox: The sandbox of the judge.
        logs: The folder for the agent's output.
        clock: The clock of the judge; the server's default if None.

    Raises:
        WildscavError: The platform failed.
    """
    if lacks_packages(submission):
        yield findings.packages(submission.folder)
    with asyncio.Runner() as runner:
        yield from _run_all(submission, sandbox, logs, clock or Clock(), runner)


def _run_all(
    submission: Submission, sandbox: Sandbox, logs: Path, clock: Clock, runner: asyncio.Runner
) -> Iterator[Finding]:
    for number, track in enumerate(submission.manifest.tracks):
        spec = suite(track, "quick", seed=0)[0]
        played, log = _play(submission, spec, sandbox, logs / f"{track}.log", clock, runner)
        seat = next(iter(played.seats))
        fitted = clock.fitted(spec)
        found = list(findings.judge_match(played.seats[seat], fitted, LIMITS, f"match: {track}"))
        if number == 0:
            yield from found
            yield findings.output(log.stat().st_size, LIMITS)
        else:
            yield from (one for one in found if one.check != "start-up")
        if played.seats[seat].status != "finished":
            return  # an agent that cannot play a match fails the rest for the same reason
        if number == 0:
            yield findings.process_exit(played.endings.get(seat))
    yield from _with_faults(submission, sandbox, logs, clock, runner)


def _with_faults(
    submission: Submission, sandbox: Sandbox, logs: Path, clock: Clock, runner: asyncio.Runner
) -> Iterator[Finding]:
    spec = short_spec(submission.manifest.tracks[0])
    late = runner.run(_delay_replies(submission, spec, sandbox, logs / "late.log"))
    yield findings.lateness(next(iter(late.seats.values())), LIMITS, clock)
    log = logs / "cancelled.log"
    prepare_logs([log])
    yield findings.cancelled_match(runner.run(_cancel_match(submission, spec, sandbox, log)), LEAVING_TIME)


def short_spec(track: str) -> MatchSpec:
    """Return a match of ten seconds on a small map."""
    small = MapSpec(config=MapConfig(size=60, houses=1), seed=1)
    return MatchSpec(track=track, map=small, seats=("submission",), time_limit=10.0)


def _play(
    submission: Submission,
    spec: MatchSpec,
    sandbox: Sandbox,
    log: Path,
    clock: Clock,
    runner: asyncio.Runner,
) -> tuple[PlayedMatch, Path]:
    """Play a match; return it with the log of the submission's first seat."""
    count = spec.seats.count("submission")
    logs = tuple(log.with_stem(f"{log.stem}-{seat}") if seat else log for seat in range(count))
    prepare_logs(logs)
    played = runner.run(play_match(Seating(spec, (submission,) * count, logs), sandbox=sandbox, clock=clock))
    return played, log


async def _delay_replies(submission: Submission, spec: MatchSpec, sandbox: Sandbox, log: Path) -> PlayedMatch:
    """Play a match in which steps are played without the agent's answers."""
    prepare_logs([log])
    async with delayed_replies(sandbox) as late:
        return await play_match(Seating(spec, (submission,), (log,)), sandbox=late, clock=TIGHT_CLOCK)


async def _cancel_match(
    submission: Submission, spec: MatchSpec, sandbox: Sandbox, log: Path
) -> Ending | None:
    """Cancel a match while it is played; return how the agent's process ended, or None if it did not."""
    seating = Seating(spec, (submission,), (log,))
    with socket_folders(1) as folders:
        server = MatchServer()
        (address,) = await server.start([f"unix:{folders[0] / 'match.sock'}"])
        try:
            sensors = {0: submission.manifest.sensors}
            hosted = await server.host(
                spec, names=seating.names, sensors=sensors, clock=Clock(), addresses={0: address}
            )
            agent = await sandbox.start(launch_for(submission, address, hosted.tokens[0], log))
            ending = asyncio.create_task(agent.ended())
            try:
                await _wait_for_step(hosted, ending)
                hosted.cancel()
                await asyncio.wait([ending], timeout=LEAVING_TIME)
                return ending.result() if ending.done() else None
            finally:
                await agent.stop()
                await asyncio.wait([ending])
        finally:
            await server.stop()


async def _wait_for_step(hosted: HostedMatch, ending: "asyncio.Task[Ending]") -> None:
    while hosted.match.step_number < CANCEL_AT and not ending.done() and not hosted.task.done():  # noqa: ASYNC110
        await asyncio.sleep(0.005)
