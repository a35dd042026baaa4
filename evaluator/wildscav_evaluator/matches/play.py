"""One match: a server of its own, a process for every agent, and the outcome.

A failure of an agent becomes the outcome of its seat. A failure of the platform (the engine, the server, a
sandbox) is no outcome: the match is played again from its start, and after several attempts given up as the
platform's fault.
"""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from wildscav.errors import SensorError, UserError, WildscavError, describe
from wildscav.terminal.console import counted
from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.agents import MatchAgents, status_of
from wildscav_evaluator.model_gateway.gateway import ModelGateway, open_gateway
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.sandbox import (
    DEFAULT_LIMITS,
    SANDBOXES,
    Ending,
    Launch,
    Limits,
    Sandbox,
    SandboxError,
)
from wildscav_evaluator.seats import display_names, submission_seats
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.hosting.hosted_match import HostedMatch, MatchCancelledError
from wildscav_server.hosting.reports import MatchOutcome, SeatReport, SeatStatus
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import MARGIN, Clock

SOCKET = "match.sock"
# Of a seat's own socket: the connections that its agent may have open at one time, and in all.
SEAT_ENDPOINT = EndpointSettings(connections=16, max_total_connections=64)
EXIT_TIME = 3.0  # s for an agent's process to end by itself after the match; a container takes 1 s
MAX_ATTEMPTS = 3  # at a match that the platform breaks
RETRY_DELAY = 0.5  # s between attempts, in which scarce resources may become available
LONGEST_STALL = 10.0  # s that our event loop may stand still; beyond that no agent is blamed
STALL_CHECK_INTERVAL = 1.0  # s between two checks for a stall
# Outcomes whose cause is how the agent's process ended.
EARLY_ENDS = (SeatStatus.CRASHED, SeatStatus.OUT_OF_MEMORY, SeatStatus.DISQUALIFIED)
# Outcomes whose cause is what the agent's code was doing.
LATE_ENDS = (SeatStatus.TIMED_OUT, SeatStatus.NEVER_JOINED)
# Errors in the request: another attempt would fail in the same way.
WRONG_REQUESTS = (MatchSetupError, SensorError, UserError)


class PlatformFaultError(WildscavError):
    """The platform broke a match in every attempt."""


@dataclass(frozen=True)
class MatchAssignment:
    """A match with its submissions in their seats."""

    spec: MatchSpec
    submissions: tuple[Submission, ...]  # in the order of their seats in the spec
    logs: tuple[Path, ...]  # one for each submission
    limits: Limits = DEFAULT_LIMITS  # of every agent
    robots: tuple[int, ...] = ()  # the seats of robots that are entrants
    seeds: tuple[int, ...] = ()  # the private seed of each submission; if empty, those of the spec
    model: ModelSettings | None = None  # that the submissions may ask
    exchanges: Path | None = None  # the file for what they ask it, and what it answers

    @property
    def seats(self) -> tuple[int, ...]:
        """The seat of each submission."""
        return submission_seats(self.spec.seats)

    @property
    def names(self) -> tuple[str, ...]:
        """The display name of every seat."""
        names = [submission.name for submission in self.submissions]
        return display_names(self.spec.seats, names, self.robots)


@dataclass(frozen=True)
class PlayedMatch:
    """A match that was played, with the reports on its seats and the ends of its agents' processes."""

    match: Match
    seats: dict[int, SeatReport]  # of the submissions' seats
    endings: dict[int, Ending] = field(default_factory=dict)  # of the processes that ended by themselves
    platform_faults: tuple[str, ...] = ()  # what broke earlier attempts, one line each


async def play_match(
    seating: MatchAssignment,
    *,
    sandbox: Sandbox = SANDBOXES["process"],
    clock: Clock | None = None,
    on_start: Callable[[HostedMatch], None] | None = None,
    make: Callable[[MatchSpec], Match] | None = None,
    faults: Sequence[str] = (),
    on_failure: Callable[[str], None] = lambda _: None,
) -> PlayedMatch:
    """Play one match, and play it again from its start if the platform broke it.

    Without a clock, it is the usual one within the seating's limits. ``make`` makes the match from its spec
    if it is not an ordinary one, and ``on_start`` is called with it whenever it is hosted. ``faults`` are
    what broke earlier attempts, which count, too; ``on_failure`` is called with what broke another one.

    MatchSetupError if the spec cannot be played; PlatformFaultError if the platform broke every attempt.
    """
    faults = list(faults)
    while True:
        try:
            played = await _play_once(agents_at_play(seating, sandbox, clock, on_start, make))
            return replace(played, platform_faults=tuple(faults))
        except Exception as error:
            # Whether a sandbox works here at all was tried before the match.
            if isinstance(error, WRONG_REQUESTS) and not isinstance(error, SandboxError):
                raise
            faults.append(_in_a_line(error))
            if len(faults) >= MAX_ATTEMPTS:
                raise PlatformFaultError(given_up(faults)) from error
        on_failure(faults[-1])
        await asyncio.sleep(RETRY_DELAY)
        prepare_logs(seating.logs)


def given_up(faults: Sequence[str]) -> str:
    """Return in one line why a match is not played again."""
    return f"the platform failed {counted(len(faults), 'time')}: {'; '.join(dict.fromkeys(faults))}"


def _in_a_line(error: Exception) -> str:
    if isinstance(error, OSError):
        return describe(error)
    return str(error) if isinstance(error, WildscavError) else f"{type(error).__name__}: {error}"


async def _play_once(
    at_play: AbstractAsyncContextManager[tuple[HostedMatch, MatchAgents]],
) -> PlayedMatch:
    """Play one match from the start of its agents to the end of the last of them. See ``agents_at_play``.

    OSError if an agent's process could not be started; PlatformFaultError if a sandbox failed under an agent.
    """
    async with at_play as (hosted, agents):
        stall = asyncio.create_task(_watch_for_stall())
        try:
            outcome = await _outcome(hosted, agents)
            await agents.leave(EXIT_TIME)
            played = PlayedMatch(outcome.match, _explained(outcome, agents), agents.endings)
            if stall.done() and any(report.status.fault for report in played.seats.values()):
                raise PlatformFaultError(f"the evaluator stood still for {stall.result():.0f} s")
            return played
        finally:
            stall.cancel()


@asynccontextmanager
async def agents_at_play(
    seating: MatchAssignment,
    sandbox: Sandbox,
    clock: Clock | None = None,
    on_start: Callable[[HostedMatch], None] | None = None,
    make: Callable[[MatchSpec], Match] | None = None,
) -> AsyncIterator[tuple[HostedMatch, MatchAgents]]:
    """Host a match and start its agents; cancel and stop them in the end. See ``play_match``."""
    async with _sockets(seating) as (folders, model):
        server = MatchServer(endpoint_settings=SEAT_ENDPOINT)
        # Each seat has its own socket: its sandbox passes on no other, and no other token works there.
        addresses = await server.start([f"unix:{folder / SOCKET}" for folder in folders])
        try:
            hosted = await server.host(
                seating.spec,
                names=seating.names,
                sensors={
                    seat: submission.sensors
                    for seat, submission in zip(seating.seats, seating.submissions, strict=True)
                },
                seeds=dict(zip(seating.seats, seating.seeds, strict=False)),
                clock=clock or Clock(longest=seating.limits.wall_clock),
                addresses=dict(zip(seating.seats, addresses, strict=True)),
                starting=True,
                make=make,
            )
            if on_start is not None:
                on_start(hosted)
            agents = MatchAgents(hosted, sandbox, model)
            try:
                entries = zip(seating.seats, seating.submissions, seating.logs, addresses, strict=True)
                launches = {
                    seat: launch_for(submission, address, hosted.tokens[seat], log, seating.limits, hosted)
                    for seat, submission, log, address in entries
                }
                async with agents.started(launches):
                    yield hosted, agents
            finally:
                hosted.cancel()
                await agents.stop()
        finally:
            await server.stop()


@asynccontextmanager
async def _sockets(seating: MatchAssignment) -> AsyncIterator[tuple[list[Path], ModelGateway | None]]:
    """Yield a private folder for the sockets of each seat, and the gateway to the model, if there is one."""
    with socket_folders(len(seating.seats)) as folders:
        by_seat = dict(zip(seating.seats, folders, strict=True))
        async with open_gateway(seating.model, by_seat, seating.exchanges) as model:
            yield folders, model


async def _watch_for_stall() -> float:
    """Wait until this event loop has stood still for long (after Ctrl-Z, say); return for how long, s."""
    loop, late = asyncio.get_running_loop(), 0.0
    while late < LONGEST_STALL:
        before = loop.time()
        await asyncio.sleep(STALL_CHECK_INTERVAL)
        late = loop.time() - before - STALL_CHECK_INTERVAL
    return late


def launch_for(
    submission: Submission,
    address: str,
    token: str,
    log: Path,
    limits: Limits = DEFAULT_LIMITS,
    hosted: HostedMatch | None = None,
) -> Launch:
    """Return what a sandbox needs to start a submission for a seat, of a match by whose clock it ends."""
    return Launch(
        folder=submission.folder,
        image=submission.image,
        entry_point=submission.manifest.entry_point or "",
        command=submission.manifest.command or (),
        address=address,
        token=token,
        log=log,
        limits=limits,
        interface=submission.manifest.interface,
        start_limit=None if hosted is None else hosted.clock.join_timeout,
        lasts=MARGIN if hosted is None else hosted.clock.deadline(hosted.match.spec),
    )


async def _outcome(hosted: HostedMatch, agents: MatchAgents) -> MatchOutcome:
    """Wait for the end of a match. If it was cancelled, report the model or the sandbox that failed."""
    try:
        return await hosted.finished()
    except MatchCancelledError:
        if agents.model is not None and agents.model.fault:
            raise PlatformFaultError(agents.model.fault) from None
        for ending in agents.endings.values():
            if ending.platform_fault:
                raise PlatformFaultError(ending.platform_fault) from None
        raise


def _explained(outcome: MatchOutcome, agents: MatchAgents) -> dict[int, SeatReport]:
    """Return the reports on all seats, with the causes that the agents' processes show.

    PlatformFaultError if a seat was empty because its sandbox failed, or had no answer of its model.
    """
    if agents.model is not None and agents.model.fault:
        raise PlatformFaultError(agents.model.fault)
    endings = agents.endings
    for seat, ending in endings.items():
        if ending.platform_fault and outcome.seats[seat].status in EARLY_ENDS:
            raise PlatformFaultError(ending.platform_fault)
    return {seat: _with_cause(report, endings.get(seat), agents) for seat, report in outcome.seats.items()}


def _with_cause(report: SeatReport, ending: Ending | None, agents: MatchAgents) -> SeatReport:
    """Return a report, completed with the cause that the agent's process shows.

    If the seat was empty because the process ended, the cause is how it ended: the server may only have
    noticed that the agent's stream is gone. If the time was up, it is what the agent's code was doing then.
    """
    if report.status in LATE_ENDS and (where := agents.overdue(report.seat)):
        return replace(report, detail=f"{report.detail}; when its time was up, its code was at {where}")
    if ending is None or report.status not in EARLY_ENDS:
        return report
    return replace(
        report,
        status=status_of(ending),
        detail=str(ending),
        exit_code=ending.exit_code,
        killed_by=ending.killed_by,
        last_lines=ending.last_lines,
    )


@contextmanager
def socket_folders(count: int) -> Iterator[list[Path]]:
    """Make private folders, one per unix socket."""
    with leftovers.temporary_folder("sockets-") as folder:
        folders = [folder / str(number) for number in range(count)]
        for each in folders:
            each.mkdir(mode=0o700)
        yield folders


def prepare_logs(logs: Sequence[Path]) -> None:
    """Create the logs, or empty those that exist."""
    for log in logs:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_bytes(b"")


def remove_empty_logs(logs: Sequence[Path]) -> None:
    """Remove the logs of agents that printed nothing."""
    for log in logs:
        if log.exists() and log.stat().st_size == 0:
            log.unlink()
