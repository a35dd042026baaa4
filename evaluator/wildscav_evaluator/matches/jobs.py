"""A job: one match of an evaluation, from its agent's start to its record and replay on disk."""

import asyncio
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from wildscav.errors import WildscavError, describe
from wildscav.server import HostedMatch, SeatReport
from wildscav_engine.record import SUFFIX, read_record, write_record
from wildscav_engine.specs.spec import MatchSpec
from wildscav_evaluator.matches.play import (
    TRIES,
    Played,
    Seating,
    given_up,
    play_match,
    prepare_logs,
    remove_empty_logs,
)
from wildscav_evaluator.matches.warm import Wanted
from wildscav_evaluator.output.journal import read_entry, write_entry
from wildscav_evaluator.output.results import MatchRow, MatchTiming, SeatRow, SeatTiming
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Limits, Sandbox
from wildscav_evaluator.seats import submission_seats
from wildscav_evaluator.submissions.submission import Submission

RECORDS, REPLAYS, LOGS = "records", "replays", "logs"
REPLAYED: Wanted = {"camera": {}, "depth": {}}  # what a replay shows of the agent that it follows
FINISHED, FAILED = "finished", "failed"
BEAT = 0.5  # s between two words on how far a match is


@dataclass(frozen=True)
class Job:
    """One match to play."""

    submission: Submission
    track: str
    index: int  # in the suite
    spec: MatchSpec
    out: Path
    replay: bool  # whether to render one
    evaluation: str = ""  # digest of the evaluation's identity
    sandbox: str = "process"  # in which its agent runs
    limits: Limits = DEFAULT_LIMITS  # of its agent
    faults: tuple[str, ...] = ()  # what the platform broke earlier tries by, a line each

    @property
    def stem(self) -> str:
        """What its files are called."""
        return stem_of(self.track, self.index, self.submission.name)

    @property
    def record(self) -> str:
        """Path of the record in the output folder."""
        return f"{RECORDS}/{self.stem}{SUFFIX}"

    @property
    def replay_path(self) -> str:
        """Path of the replay in the output folder."""
        return f"{REPLAYS}/{self.stem}.rrd"

    @property
    def seats(self) -> tuple[int, ...]:
        """The seats that the submission fills: all that a submission may."""
        return submission_seats(self.spec.seats)

    def log(self, seat: int) -> str:
        """Path of the log of a seat's agent in the output folder."""
        # No name of a submission has a dot: what stands before the first one is always the stem.
        return f"{LOGS}/{self.stem}.log" if len(self.seats) == 1 else f"{LOGS}/{self.stem}.seat-{seat}.log"

    @property
    def seating(self) -> Seating:
        """The match, with this submission in every seat that a submission fills."""
        logs = tuple(self.out / self.log(seat) for seat in self.seats)
        return Seating(self.spec, (self.submission,) * len(logs), logs, self.limits)


def stem_of(track: str, index: int, submission: str) -> str:
    """Return what the files of a submission's match are called."""
    return f"{track}-{index:03d}-{submission}"


def sensors_read(jobs: Sequence[Job]) -> list[Wanted]:
    """Return the sensors that are read in some matches and in their replays."""
    wanted = {job.submission.folder: job.submission.manifest.sensors for job in jobs}
    replayed = [REPLAYED] if any(job.replay for job in jobs) else []
    return [*wanted.values(), *replayed]


class Beat(NamedTuple):
    """How far a match has come that is being played."""

    frames: int
    steps: int


class Broken(NamedTuple):
    """A try that the platform broke; the match is played again."""

    reason: str  # in a line


class Rendering(NamedTuple):
    """The match was played, and its replay is being rendered."""


Told = Beat | Broken | Rendering  # of a job that a worker is at


@dataclass(frozen=True)
class JobResult:
    """What became of a job."""

    job: Job
    row: MatchRow
    timing: MatchTiming | None = None  # none if no match was played
    complaint: str = ""  # what went wrong besides the match, such as a replay that could not be written

    @property
    def to_render(self) -> bool:
        """Whether a replay is asked for and missing."""
        return self.job.replay and self.row.record is not None and self.row.replay is None


def run_job(runner: asyncio.Runner, job: Job, tell: Callable[[Told], None] = lambda _: None) -> JobResult:
    """Play a job's match, unless it was played before, and write its files.

    Whatever goes wrong costs this job alone.

    Args:
        runner: Of the loop to play in.
        job: The job.
        tell: Told now and then how far the match is, when it is played again, and when its replay is begun.
    """
    result = kept(job) or _play(runner, job, tell)
    if not result.to_render:
        return result
    tell(Rendering())
    return _rendered(result)


def kept(job: Job) -> JobResult | None:
    """Return the result of a job whose match was played to its end in an earlier sitting."""
    entry = read_entry(job.out, job.evaluation, job.stem)
    if entry is None:
        return None
    rendered = job.replay and (job.out / job.replay_path).exists()
    return JobResult(job, _with_replay(job, entry.row) if rendered else entry.row, entry.timing)


def after_death(job: Job, reason: str) -> Job | JobResult:
    """Return what becomes of a job whose worker died: the job once more, or its result.

    Args:
        job: The job, with all that broke it before.
        reason: How the worker ended, in a line.
    """
    faults = (*job.faults, reason)
    if len(faults) < TRIES:
        return replace(job, faults=faults)
    played = kept(job)
    if played is not None:
        return replace(played, complaint=f"no replay {job.out / job.replay_path}: {given_up(faults)}")
    return failed(job, given_up(faults))


def _play(runner: asyncio.Runner, job: Job, tell: Callable[[Told], None]) -> JobResult:
    started, clock = time.time(), time.perf_counter()
    seating = job.seating
    try:
        prepare_logs(seating.logs)
        played = runner.run(_play_telling(seating, SANDBOXES[job.sandbox], job.faults, tell))
        write_record(job.out / job.record, played.match, seating.names)
        remove_empty_logs(seating.logs)
        row = MatchRow.of(job.index, tuple(_seat(job, played, seat) for seat in job.seats), job.record)
        timing = _timing(job, played, started, time.perf_counter() - clock)
        # From here on the match is played, whatever happens.
        write_entry(job.out, job.evaluation, job.stem, row, timing)
        return JobResult(job, row, timing)
    except OSError as error:
        return failed(job, describe(error))
    except (WildscavError, ValueError) as error:
        return failed(job, str(error))
    except Exception as error:  # noqa: BLE001 (a match that breaks must not take the others along)
        return failed(job, f"{type(error).__name__}: {error}")


async def _play_telling(
    seating: Seating, sandbox: Sandbox, faults: Sequence[str], tell: Callable[[Told], None]
) -> Played:
    """Play a match, and tell how far it is; from its start again, if it is played again."""
    telling: list[asyncio.Task[None]] = []

    async def beat(hosted: HostedMatch) -> None:
        while True:
            tell(Beat(hosted.match.frame, hosted.match.step_number))
            await asyncio.sleep(BEAT)

    def begin(hosted: HostedMatch) -> None:
        for task in telling:
            task.cancel()
        telling.append(asyncio.create_task(beat(hosted)))

    try:
        with _cancelled_by_signal():
            return await play_match(
                seating,
                sandbox=sandbox,
                started=begin,
                faults=faults,
                broken=lambda reason: tell(Broken(reason)),
            )
    finally:
        for task in telling:
            task.cancel()


@contextmanager
def _cancelled_by_signal() -> Iterator[None]:
    """Have SIGTERM cancel this task, which ends all that it started (in the main thread).

    A handler that raises would do so in whatever task just runs, and keep the others from ending in order.
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
    """Return the result of a job that came to no result, by no fault of the agent."""
    return JobResult(job, MatchRow(index=job.index, status=FAILED, fault="platform", detail=reason))


def _rendered(result: JobResult) -> JobResult:
    """Return a result with its replay, rendered now if it is missing, or with what went wrong."""
    complaint = _render(result.job)
    row = result.row if complaint else _with_replay(result.job, result.row)
    return replace(result, row=row, complaint=complaint)


def _with_replay(job: Job, row: MatchRow) -> MatchRow:
    return row.model_copy(update={"replay": job.replay_path})


def _render(job: Job) -> str:
    """Render the replay from the record; return what went wrong, if anything did."""
    from wildscav_engine.view import write_replay

    path = job.out / job.replay_path
    try:
        write_replay(read_record(job.out / job.record), path, follow=job.seats[0])
    except OSError as error:
        return f"no replay {path}: {error.strerror or error}"
    except Exception as error:  # noqa: BLE001 (the match stands, whatever becomes of its picture)
        return f"no replay {path}: {type(error).__name__}: {error}"
    return ""


def _seat(job: Job, played: Played, seat: int) -> SeatRow:
    report, log = played.seats[seat], job.log(seat)
    return SeatRow(
        seat=seat,
        status=report.status.value,
        fault=fault.value if (fault := report.status.fault) else None,
        detail=report.detail,
        exit_code=report.exit_code,
        killed_by=report.killed_by,
        last_lines=report.last_lines,
        actions=report.steps_played,
        invalid_actions=report.invalid_actions,
        ignored_fields=report.ignored_fields,
        metrics=dict(played.match.result().seats[seat].metrics),
        log=log if (job.out / log).exists() else None,
    )


def _timing(job: Job, played: Played, started: float, wall: float) -> MatchTiming:
    return MatchTiming(
        submission=job.submission.name,
        track=job.track,
        index=job.index,
        started=started,
        wall=wall,
        steps=played.match.step_number,
        seats=tuple(
            _seat_timing(played.seats[seat], played.late_for_platform.get(seat, ())) for seat in job.seats
        ),
        platform_faults=played.platform_faults,
    )


def _seat_timing(report: SeatReport, late_for_platform: tuple[int, ...]) -> SeatTiming:
    time = report.think_time
    return SeatTiming(
        seat=report.seat,
        start_up=report.start_up,
        steps=report.steps_played + report.late_steps,
        late_steps=report.late_steps,
        late_for_platform=late_for_platform,
        dropped_actions=report.dropped_actions,
        time_used=time.total,
        latency_p50=time.p50,
        latency_p99=time.p99,
        latency_max=time.max,
        time_bank=report.time_bank,
    )
