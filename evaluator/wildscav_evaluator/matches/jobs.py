"""Jobs: the matches of an evaluation, the events of a job while it runs, and its result."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Self

from wildscav_engine.record import SUFFIX
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.play import MatchAssignment
from wildscav_evaluator.matches.snapshots import Snapshot
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.output.layout import EXCHANGES, LOGS, RECORDS, REPLAYS, stem_of
from wildscav_evaluator.output.results import MatchRow, MatchTiming
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, Limits
from wildscav_evaluator.seats import entrants_of_seats, submission_seats
from wildscav_evaluator.submissions.submission import Submission

Wanted = dict[str, dict[str, Any]]  # sensors by name, with their options
REPLAYED: Wanted = {"camera": {}, "depth": {}}  # sensors that a replay shows of the agent that it follows


@dataclass(frozen=True)
class Job:
    """One match to play.

    In an evaluation, one submission fills all seats for submissions. In a tournament, several entrants meet:
    submissions, and robots that take part like them.
    """

    submissions: tuple[Submission, ...]  # of the seats for submissions, in the order of the seats
    track: str
    index: int  # in the suite or in the tournament
    spec: MatchSpec
    out: Path
    replay: bool  # whether to render one
    key: str = ""  # by which the caller of an executor knows it
    sandbox: str = "process"  # the name of the sandbox in which its agent runs
    limits: Limits = DEFAULT_LIMITS  # of its agent
    faults: tuple[str, ...] = ()  # what broke earlier attempts, one line each
    evaluated: str | None = None  # the submission whose evaluation it belongs to; None in a tournament
    robots: tuple[int, ...] = ()  # the seats of robots that are entrants
    seeds: tuple[int, ...] = ()  # the private seed of each submission; if empty, those of the spec
    model: ModelSettings | None = None  # that its submissions may ask
    watched: bool = False  # whether its heartbeats carry snapshots, for spectators
    kept: "KeptMatch | None" = None  # how it went, if it was played before and lacks only its replay

    @classmethod
    def of_one(
        cls,
        submission: Submission,
        track: str,
        index: int,
        spec: MatchSpec,
        out: Path,
        replay: bool,
        **others: Any,
    ) -> Self:
        """Return the job of a match in which one submission fills all seats for submissions."""
        submissions = (submission,) * len(submission_seats(spec.seats))
        return cls(submissions, track, index, spec, out, replay, evaluated=submission.name, **others)

    @property
    def stem(self) -> str:
        """The stem of its files' names."""
        return stem_of(self.track, self.index, self.evaluated)

    @property
    def record(self) -> str:
        """Path of the record in the output folder."""
        return f"{RECORDS}/{self.stem}{SUFFIX}"

    @property
    def exchanges(self) -> str:
        """Path, in the output folder, of what its agents asked a model."""
        return f"{EXCHANGES}/{self.stem}.jsonl.gz"

    @property
    def replay_path(self) -> str:
        """Path of the replay in the output folder."""
        return f"{REPLAYS}/{self.stem}.rrd"

    @property
    def seats(self) -> tuple[int, ...]:
        """The seats that agents of submissions fill."""
        return submission_seats(self.spec.seats)

    @property
    def entrants(self) -> dict[int, str]:
        """The name of the entrant in each seat that has one, in the order of the seats."""
        names = [submission.name for submission in self.submissions]
        return entrants_of_seats(self.spec.seats, names, self.robots)

    def log(self, seat: int) -> str:
        """Path of the log of a seat's agent in the output folder."""
        # No stem has a dot, so the part before the first dot is always the stem.
        return f"{LOGS}/{self.stem}.log" if len(self.seats) == 1 else f"{LOGS}/{self.stem}.seat-{seat}.log"

    @property
    def seating(self) -> MatchAssignment:
        """The match, with the submissions in their seats."""
        logs = tuple(self.out / self.log(seat) for seat in self.seats)
        exchanges = None if self.model is None else self.out / self.exchanges
        seats = self.limits, self.robots, self.seeds
        return MatchAssignment(self.spec, self.submissions, logs, *seats, self.model, exchanges)


def sensors_read(jobs: Sequence[Job]) -> list[Wanted]:
    """Return the sensors that the agents and the replays of some matches read."""
    wanted = {one.folder: one.sensors for job in jobs for one in job.submissions}
    replayed = [REPLAYED] if any(job.replay for job in jobs) else []
    return [*wanted.values(), *replayed]


class Heartbeat(NamedTuple):
    """The progress of a match that is being played."""

    frames: int
    steps: int
    snapshots: tuple[Snapshot, ...] = ()  # of a match that is watched, since the last heartbeat


class AttemptFailed(NamedTuple):
    """An attempt that the platform broke; the match is played again."""

    reason: str  # in one line


class KeptMatch(NamedTuple):
    """How a match went whose record is in the output folder."""

    row: MatchRow
    timing: MatchTiming | None


class RenderingReplay(NamedTuple):
    """The match was played, and its replay is being rendered."""

    kept: KeptMatch | None = None  # None if its record is not in the output folder yet


JobEvent = Heartbeat | AttemptFailed | RenderingReplay  # of a job that a worker is running


@dataclass(frozen=True)
class JobResult:
    """The result of a job."""

    job: Job
    row: MatchRow
    timing: MatchTiming | None = None  # None if no match was played
    replay_error: str = ""  # why its replay could not be written

    @property
    def rows(self) -> dict[str, MatchRow]:
        """How the match went for each entrant, by its name."""
        if self.job.evaluated is not None:
            return {self.job.evaluated: self.row}
        return {name: self.row.of_entrant(name) for name in dict.fromkeys(self.job.entrants.values())}

    @property
    def to_render(self) -> bool:
        """Whether a replay is requested and missing."""
        return self.job.replay and self.row.record is not None and self.row.replay is None


def cores_of(job: Job, largest_node: int) -> int:
    """Return the cores that a match reserves: those that its agents may use at the same time.

    The server needs none besides, since it computes while all agents wait for it. A match with more agents
    than any node has cores gets a whole node.
    """
    wanted = math.ceil(len(job.seats) * job.limits.cpus)
    return max(1, min(wanted, largest_node))
