"""The state of an evaluation: matches waiting, running, done and failed, scores so far, and the time left."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobResult
from wildscav_evaluator.output.results import MetricInfo, Summary, metric_infos
from wildscav_evaluator.scores.score import summarize

ROBOT = 0.1  # time that a robot takes, as a share of the time of an agent in its own process
SMOOTHING = 0.5  # weight of the newest measurement of steps per second


@dataclass
class TrackProgress:
    """The progress of one submission on one track."""

    track: str
    submission: str
    metric: MetricInfo  # the score
    total: int = 0
    done: int = 0
    running: int = 0
    failed: int = 0
    scores: list[float] = field(default_factory=list)
    _summary: tuple[int, Summary] | None = None  # of so many scores

    @property
    def summary(self) -> Summary | None:
        """The scores so far; None if there are none."""
        # Computed on request, because of many entrants only a few are shown.
        scores = tuple(self.scores)  # copied, because the dashboard is drawn by another thread
        if scores and (self._summary is None or self._summary[0] != len(scores)):
            self._summary = len(scores), summarize(scores)
        return None if self._summary is None else self._summary[1]

    @property
    def complete(self) -> bool:
        """Whether all its matches are done."""
        return self.done == self.total


@dataclass
class RunningMatch:
    """A match that is being played."""

    job: Job
    since: float  # s, by the tally's clock
    heartbeat: Heartbeat | None = None
    heartbeat_at: float = 0.0
    speed: float = 0.0  # steps/s


class Tally:
    """Counts the states and results of jobs.

    ``clock`` returns seconds since any fixed moment; ``nodes`` the machines of a cluster, if one plays them.
    """

    def __init__(
        self,
        jobs: Sequence[Job],
        at_once: int = 1,
        clock: Callable[[], float] = time.monotonic,
        nodes: Callable[[], tuple[Node, ...]] = tuple,
    ) -> None:
        self.nodes = nodes
        self.at_once, self.clock, self.began = at_once, clock, clock()
        self.jobs = {job.stem: job for job in jobs}
        self.done: dict[str, JobResult] = {}
        self.running: dict[str, RunningMatch] = {}
        self.failed = 0  # matches in which something went wrong
        self.broken = 0  # attempts that the platform broke, each played again
        self.lines: dict[tuple[str, str], TrackProgress] = {}
        for job in jobs:
            for key in self._keys(job):
                if key not in self.lines:
                    self.lines[key] = TrackProgress(*key, metric_infos(job.track)[0])
                self.lines[key].total += 1

    # Events.

    def start(self, job: Job) -> None:
        """Count a match that begins, or begins again."""
        begins = job.stem not in self.done and job.stem not in self.running
        for line in self._lines(job):
            line.running += begins
        self.running[job.stem] = RunningMatch(job, self.clock())

    def beat(self, job: Job, heartbeat: Heartbeat) -> None:
        """Note the progress of a running match."""
        running = self.running.get(job.stem)
        if running is None:
            return
        now, before = self.clock(), running.heartbeat
        if before is not None and now > running.heartbeat_at and heartbeat.steps >= before.steps:
            speed = (heartbeat.steps - before.steps) / (now - running.heartbeat_at)
            running.speed += (speed - running.speed) * (SMOOTHING if running.speed else 1.0)
        running.heartbeat, running.heartbeat_at = heartbeat, now

    def add_earlier(self, result: JobResult) -> list[TrackProgress]:
        """Count a match that an earlier run played, and return the lines of its entrants."""
        if result.timing is not None:
            self.broken += len(result.timing.platform_faults)
        return self.add(result)

    def note_broken(self, job: Job) -> None:
        """Count an attempt at a running match that the platform broke."""
        self.broken += 1
        if (running := self.running.get(job.stem)) is not None:
            running.heartbeat = None

    def add(self, result: JobResult) -> list[TrackProgress]:
        """Count a match that ended, and return the lines of its entrants."""
        lines, stem = self._lines(result.job), result.job.stem
        was_running = self.running.pop(stem, None) is not None
        counted = stem in self.done
        self.done[stem] = result
        if counted:
            return lines  # only its replay was rendered
        for line, row in zip(lines, result.rows.values(), strict=True):
            line.running -= was_running
            line.done += 1
            line.failed += row.fault is not None
            if row.metrics is not None:
                line.scores.append(row.metrics[line.metric.name])
        self.failed += result.row.fault is not None
        return lines

    def _lines(self, job: Job) -> list[TrackProgress]:
        return [self.lines[key] for key in self._keys(job)]

    def _keys(self, job: Job) -> list[tuple[str, str]]:
        """Return the keys of the lines of a match: one for each of its entrants."""
        if job.evaluated is not None:
            return [(job.track, job.evaluated)]
        return [(job.track, name) for name in dict.fromkeys(job.entrants.values())]

    # State.

    @property
    def waiting(self) -> int:
        """Matches that have not begun."""
        return len(self.jobs) - len(self.done.keys() | self.running.keys())

    @property
    def elapsed(self) -> float:
        """Seconds since this run began."""
        return self.clock() - self.began

    @property
    def speed(self) -> float:
        """Steps per second of all matches that are being played."""
        return sum(running.speed for running in tuple(self.running.values()))

    def time_left(self) -> float | None:
        """Return an estimate of the seconds left; None as long as no match has been timed.

        A match is expected to take as long as the others of its track did or, if none of them is done yet, as
        long per second of game time and agent as the matches of other tracks did.
        """
        done = tuple(self.done.values())  # copied, because another thread may read the metrics
        walls = [(result.job, result.timing.wall) for result in done if result.timing is not None]
        if not walls:
            return None
        rate = sum(wall for _, wall in walls) / sum(_work(job) for job, _ in walls)
        by_track: dict[str, list[float]] = {}
        for job, wall in walls:
            by_track.setdefault(job.track, []).append(wall)
        left = 0.0
        for stem, job in self.jobs.items():
            if stem in self.done:
                continue
            known = by_track.get(job.track)
            expected = sum(known) / len(known) if known else rate * _work(job)
            running = self.running.get(stem)
            left += expected if running is None else max(0.0, expected - (self.clock() - running.since))
        at_once = max(1, min(self.at_once, len(self.jobs) - len(self.done)))
        return left / at_once


def _work(job: Job) -> float:
    """Return the expected effort of a match, in seconds of game time times agents."""
    agents = job.spec.seats.count(SUBMISSION)
    return job.spec.time_limit * (agents + ROBOT * (len(job.spec.seats) - agents))
