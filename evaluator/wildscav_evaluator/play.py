"""One match: a server of its own, a process for every agent, and the outcome."""

import asyncio
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from wildscav.server import Clock, HostedMatch, MatchServer, SeatReport, SeatStatus
from wildscav_engine.match import Match
from wildscav_engine.spec import MatchSpec
from wildscav_evaluator.sandbox import SANDBOXES, Ending, Launch, RunningAgent, Sandbox
from wildscav_evaluator.seating import display_names, submission_seats
from wildscav_evaluator.submission import Submission

SOCKET_PATH_LIMIT = 100  # bytes; the systems' own limits begin at 104
FAREWELL = 1.0  # s for an agent's process to end by itself after the match


@dataclass(frozen=True)
class Seating:
    """A match with its submissions in their seats."""

    spec: MatchSpec
    submissions: tuple[Submission, ...]  # in the order of the spec's seats for submissions
    logs: tuple[Path, ...]  # one for each submission

    @property
    def seats(self) -> tuple[int, ...]:
        """The seat of each submission."""
        return submission_seats(self.spec.seats)

    @property
    def names(self) -> tuple[str, ...]:
        """The display name of every seat."""
        return display_names(self.spec.seats, [submission.name for submission in self.submissions])


@dataclass(frozen=True)
class Played:
    """A match that was played, and how its agents' processes ended."""

    match: Match
    seats: dict[int, SeatReport]  # of the submissions' seats


async def play_match(
    seating: Seating,
    *,
    sandbox: Sandbox = SANDBOXES["process"],
    clock: Clock | None = None,
    started: Callable[[HostedMatch], None] | None = None,
) -> Played:
    """Play one match from the start of its agents to the end of the last of them.

    Args:
        seating: The match, and who plays.
        sandbox: How the agents run.
        clock: How long they may think; the server's default if none.
        started: Told of the match once it is hosted.

    Raises:
        MatchSetupError: The match's spec cannot be played.
        OSError: An agent's process could not be started.
    """
    with _socket_folder() as folder:
        server = MatchServer()
        (address,) = await server.start([f"unix:{folder / 'match.sock'}"])
        try:
            hosted = await server.host(
                seating.spec,
                names=seating.names,
                sensors={
                    seat: submission.manifest.sensors
                    for seat, submission in zip(seating.seats, seating.submissions, strict=True)
                },
                clock=clock or Clock(),
            )
            if started is not None:
                started(hosted)
            return await _play_hosted(hosted, seating, address, sandbox)
        finally:
            await server.stop()


async def _play_hosted(hosted: HostedMatch, seating: Seating, address: str, sandbox: Sandbox) -> Played:
    agents: list[RunningAgent] = []
    watchers: dict[int, asyncio.Task[Ending]] = {}
    try:
        for seat, submission, log in zip(seating.seats, seating.submissions, seating.logs, strict=True):
            launch = Launch(
                folder=submission.folder,
                entry_point=submission.manifest.entry_point,
                address=address,
                token=hosted.tokens[seat],
                log=log,
            )
            agents.append(await sandbox.start(launch))
            watchers[seat] = asyncio.create_task(_watch(hosted, seat, agents[-1]))
        outcome = await hosted.finished()
        await asyncio.wait(watchers.values(), timeout=FAREWELL)
        endings = {seat: watcher.result() for seat, watcher in watchers.items() if watcher.done()}
        reports = {seat: _explained(report, endings.get(seat)) for seat, report in outcome.seats.items()}
        return Played(outcome.match, reports)
    finally:
        hosted.cancel()
        for watcher in watchers.values():
            watcher.cancel()
        ends = [*(agent.stop() for agent in agents), *watchers.values()]
        await asyncio.gather(*ends, return_exceptions=True)


async def _watch(hosted: HostedMatch, seat: int, agent: RunningAgent) -> Ending:
    """Tell the match when an agent's process is gone, so that nobody waits for it; return how it ended."""
    ending = await agent.ended()
    hosted.give_up(seat, str(ending))
    return ending


def _explained(report: SeatReport, ending: Ending | None) -> SeatReport:
    """Return a report that says how the process ended, where that is why the seat was empty.

    The server may notice first that the agent's stream is gone, and knows no more than that.
    """
    if ending is None or report.status not in (SeatStatus.LEFT, SeatStatus.NEVER_JOINED):
        return report
    return replace(report, detail=str(ending))


@contextmanager
def _socket_folder() -> Iterator[Path]:
    """Make a private folder for a unix socket, with a path short enough for one."""
    folder = Path(tempfile.mkdtemp(prefix="wildscav-"))
    if len(bytes(folder)) + len("/match.sock") > SOCKET_PATH_LIMIT:
        folder.rmdir()
        folder = Path(tempfile.mkdtemp(prefix="wildscav-", dir="/tmp"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def prepare_logs(logs: Sequence[Path]) -> None:
    """Begin the logs anew.

    Raises:
        OSError: One cannot be written.
    """
    for log in logs:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_bytes(b"")


def remove_empty_logs(logs: Sequence[Path]) -> None:
    """Remove the logs of agents that printed nothing."""
    for log in logs:
        if log.exists() and log.stat().st_size == 0:
            log.unlink()
