"""Running a job: one match, from the start of its agents to its record and replay on disk."""

import asyncio
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from wildscav.errors import WildscavError, describe
from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_evaluator.matches.jobs import (
    AttemptFailed,
    Heartbeat,
    Job,
    JobEvent,
    JobResult,
    KeptMatch,
    RenderingReplay,
)
from wildscav_evaluator.matches.play import (
    MAX_ATTEMPTS,
    MatchAssignment,
    PlayedMatch,
    given_up,
    play_match,
    prepare_logs,
    remove_empty_logs,
)
from wildscav_evaluator.matches.snapshots import HEARTBEAT_INTERVAL, Snapshot, WatchedMatch
from wildscav_evaluator.output.results import FAILED, FINISHED, MatchRow, MatchTiming, SeatRow, SeatTiming
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.reports import SeatReport

SNAPSHOT_INTERVAL = 0.1  # s between two snapshots of a match that is watched, at least, and
SNAPSHOT_FRAMES = 5  # so many frames


def run_job(
    runner: asyncio.Runner, job: Job, on_event: Callable[[JobEvent], None] = lambda _: None
) -> JobResult:
    """Play a job's match, unless it was played before, and write its files.

    Every error becomes the result of this job, so that the other jobs go on. ``on_event`` hears of the
    match's progress, of another attempt, and when the rendering of its replay begins.
    """
    result = _play(runner, job, on_event) if job.kept is None else JobResult(job, *job.kept)
    if not result.to_render:
        return result
    on_event(RenderingReplay(KeptMatch(result.row, result.timing)))
    error = _render(job)
    row = result.row if error else result.row.model_copy(update={"replay": job.replay_path})
    return replace(result, row=row, replay_error=error)


def after_worker_death(job: Job, reason: str) -> Job | JobResult:
    """Return the job to run again after its worker died, or its result if there were too many attempts."""
    faults = (*job.faults, reason)
    if len(faults) < MAX_ATTEMPTS:
        return replace(job, faults=faults)
    if job.kept is not None:
        return JobResult(job, *job.kept, f"no replay {job.out / job.replay_path}: {given_up(faults)}")
    return failed(job, given_up(faults))


def _play(runner: asyncio.Runner, job: Job, on_event: Callable[[JobEvent], None]) -> JobResult:
    started, clock = time.time(), time.perf_counter()
    seating = job.seating
    try:
        prepare_logs(seating.logs)
        played = runner.run(_play_with_heartbeats(seating, job, on_event))
        write_record(job.out / job.record, played.match, seating.names)
        remove_empty_logs(seating.logs)
        row = MatchRow.of(job.index, tuple(seat_row(job, played, seat) for seat in job.entrants), job.record)
        return JobResult(job, row, match_timing(job, played, started, time.perf_counter() - clock))
    except OSError as error:
        return failed(job, describe(error))
    except (WildscavError, ValueError) as error:
        return failed(job, str(error))
    except Exception as error:  # noqa: BLE001 (a broken match must not stop the others)
        return failed(job, f"{type(error).__name__}: {error}")


async def _play_with_heartbeats(
    seating: MatchAssignment, job: Job, on_event: Callable[[JobEvent], None]
) -> PlayedMatch:
    """Play a match and report its progress, from the start again if the match is played again."""
    beats = _Heartbeats(on_event)
    try:
        with _cancelled_by_signal():
            played = await play_match(
                seating,
                sandbox=SANDBOXES[job.sandbox],
                on_start=beats.begin,
                make=WatchedMatch if job.watched else None,
                faults=job.faults,
                on_failure=lambda reason: on_event(AttemptFailed(reason)),
            )
        beats.tell_end(played.match)
        return played
    finally:
        beats.stop()


class _Heartbeats:
    """The heartbeats of a match, with snapshots if it is watched."""

    def __init__(self, on_event: Callable[[JobEvent], None]) -> None:
        self._on_event = on_event
        self._task: asyncio.Task[None] | None = None
        self._snapshots: list[Snapshot] = []  # since the last heartbeat
        self._shown = -SNAPSHOT_FRAMES  # the frame of the last snapshot

    def begin(self, hosted: HostedMatch) -> None:
        """Follow a match from its start."""
        self.stop()
        self._snapshots, self._shown = [], -SNAPSHOT_FRAMES
        self._task = asyncio.create_task(self._beat(hosted.match))

    def stop(self) -> None:
        """Follow it no longer."""
        if self._task is not None:
            self._task.cancel()

    def tell_end(self, match: Match) -> None:
        """Tell what happened since the last heartbeat of a watched match that is over."""
        self._observe(match, 1)
        if self._snapshots:
            self._tell(match)

    async def _beat(self, match: Match) -> None:
        while True:
            self._tell(match)
            for _ in range(round(HEARTBEAT_INTERVAL / SNAPSHOT_INTERVAL)):
                await asyncio.sleep(SNAPSHOT_INTERVAL)
                self._observe(match, SNAPSHOT_FRAMES)

    def _tell(self, match: Match) -> None:
        self._on_event(Heartbeat(match.frame, match.step_number, tuple(self._snapshots)))
        self._snapshots.clear()

    def _observe(self, match: Match, frames: int) -> None:
        """Take a snapshot, unless fewer new frames than some number have been played."""
        if isinstance(match, WatchedMatch) and match.frame >= self._shown + frames:
            self._shown = match.frame
            self._snapshots.append(match.happenings.take())


@contextmanager
def _cancelled_by_signal() -> Iterator[None]:
    """Let SIGTERM cancel this task, which stops everything that it started (only in the main thread).

    A handler that raises would do so in the task that happens to run, and the others would not end cleanly.
    """
    task, loop = asyncio.current_task(), asyncio.get_running_loop()
    if task is None or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGTERM)
    loop.add_signal_handler(signal.SIGTERM, task.cancel)
    try:
        yield
    finally:
        loop.remove_signal_handler(signal.SIGTERM)
        signal.signal(signal.SIGTERM, before)


def failed(job: Job, reason: str) -> JobResult:
    """Return the result of a job whose match could not be played, through no fault of the agent."""
    return JobResult(job, MatchRow(index=job.index, status=FAILED, fault="platform", detail=reason))


def _render(job: Job) -> str:
    """Render the replay from the record; return the error, or an empty text."""
    from wildscav_engine.view import write_replay

    path = job.out / job.replay_path
    try:
        # In a tournament, a match may have robots alone.
        write_replay(read_record(job.out / job.record), path, follow=(job.seats or job.robots)[0])
    except OSError as error:
        return f"no replay {path}: {error.strerror or error}"
    except Exception as error:  # noqa: BLE001 (the match counts even without its replay)
        return f"no replay {path}: {type(error).__name__}: {error}"
    return ""


def seat_row(job: Job, played: PlayedMatch, seat: int) -> SeatRow:
    """Return how a match went in an entrant's seat, as a row of the results file."""
    metrics = dict(played.match.result().seats[seat].metrics)
    # In an evaluation every seat is the submission's.
    rated = job.evaluated is None
    entrant, team = (job.entrants[seat], job.spec.team_of_seats[seat]) if rated else (None, None)
    if seat in job.robots:
        return SeatRow(seat=seat, submission=entrant, team=team, status=FINISHED, metrics=metrics)
    report, log = played.seats[seat], job.log(seat)
    return SeatRow.about(
        report,
        submission=entrant,
        team=team,
        status=report.status.value,
        fault=fault.value if (fault := report.status.fault) else None,
        actions=report.steps_played,
        metrics=metrics,
        log=log if (job.out / log).exists() else None,
    )


def match_timing(job: Job, played: PlayedMatch, started: float, wall: float) -> MatchTiming:
    """Return how long a match took, as an entry of the results file.

    It ``started`` in seconds since 1970, UTC. ``wall`` includes the start of the agents and writing the
    record, s.
    """
    return MatchTiming(
        submission=job.evaluated,
        track=job.track,
        index=job.index,
        started=started,
        wall=wall,
        steps=played.match.step_number,
        seats=tuple(_seat_timing(played.seats[seat]) for seat in job.seats),
        platform_faults=played.platform_faults,
    )


def _seat_timing(report: SeatReport) -> SeatTiming:
    times = report.think_time
    return SeatTiming.about(
        report,
        steps=report.steps_played + report.late_steps,
        time_used=times.total,
        latency_p50=times.p50,
        latency_p99=times.p99,
        latency_max=times.max,
    )
