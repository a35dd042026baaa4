"""The schema of ``results.json``: all results of an evaluation, in a format that other programs may rely on.

Two runs of the same command give equal files, except for ``timings``.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, JsonValue

from wildscav.errors import UserError
from wildscav_engine import ENGINE_VERSION, SIMULATION_VERSION
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import RECORD_VERSION
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.bounds import MAX_EVALUATIONS, MAX_ROUNDS
from wildscav_evaluator.output.json_files import FileModel, FileModelError, WithOptionalFields
from wildscav_evaluator.output.layout import RESULTS_FILE
from wildscav_evaluator.suites.seeds import label

SCHEDULE_VERSION = 2  # rises whenever the same settings and seed give another schedule
Count = Annotated[int, Field(ge=1, le=1000)]
FORMAT = 2

BROWSER = "browser"  # the sandbox of people, who play there
FINISHED, FAILED = "finished", "failed"  # status of a seat, and of a match that could not be played

Fault = Literal["agent", "platform"]
OtherInterface = Literal["words", "keys"]  # than numbers


class TournamentSettings(FileModel):
    """Who sits where in the matches of a tournament."""

    seats: Count  # that entrants fill in a match
    team_size: Count = 1  # seats of a team
    mixed: bool = False  # whether the seats of a team are different entrants; else they are all one entrant
    repeats: Count = 2  # how often a game (a map and a match seed) is played, each time in other seats
    robots: tuple[str, ...] = ()  # that fill further seats of every match and are not rated
    meet_own: bool = False  # whether two entries of one submission may meet
    schedule: int = SCHEDULE_VERSION  # the version of the schedule

    @property
    def places(self) -> int:
        """The number of entrants in a match."""
        return self.seats if self.mixed else self.seats // self.team_size


class Versions(FileModel):
    """The versions of Wildscav's parts with which an evaluation was played."""

    engine: str  # of the whole package
    simulation: int  # of the rules
    generator: int  # of the maps
    record: int  # of the format of records

    def __str__(self) -> str:
        """Return all versions in one line."""
        return (
            f"engine {self.engine}, simulation {self.simulation}, generator {self.generator}, "
            f"records {self.record}"
        )


CURRENT_VERSIONS = Versions(
    engine=ENGINE_VERSION,
    simulation=SIMULATION_VERSION,
    generator=GENERATOR_VERSION,
    record=RECORD_VERSION,
)


class MetricInfo(FileModel):
    """The description of a metric."""

    name: str
    title: str
    unit: str  # empty: none
    lower_is_better: bool


def metric_infos(track: str, more: Iterable[str] = ()) -> tuple[MetricInfo, ...]:
    """Return the metrics of a track, the score first, and those that matches request in addition, by name."""
    from wildscav_engine.tracks import metrics_of

    return tuple(MetricInfo(**metric._asdict()) for metric in metrics_of(track, more))


class Summary(FileModel):
    """One metric over the matches played."""

    mean: float
    std: float | None  # of the sample; None for a single match
    low: float  # of the bootstrap 95 % interval of the mean
    high: float


class SeatRow(WithOptionalFields):
    """One seat of a submission in a match. Most matches have one; an organizer's suite may have several."""

    omitted = ("submission", "team")

    seat: int
    submission: str | None = None  # in a tournament, the entrant whose seat it is; omitted in an evaluation
    team: int | None = None  # in a tournament, the seat's; omitted in an evaluation
    # The outcome: "finished", "timed_out", "crashed", "out_of_memory", "protocol_error", "over_budget",
    # "disqualified" or "never_joined".
    status: str
    fault: Fault | None = None  # whose fault it is, if something went wrong
    detail: str = ""  # what went wrong, in one line
    exit_code: int | None = None  # of a process that ended before the match did; None if a signal ended it
    killed_by: str = ""  # that signal, such as SIGKILL
    last_lines: tuple[str, ...] = ()  # the last lines that such a process printed
    actions: int = 0  # answers of the agent that came in time
    invalid_actions: int = 0  # those with a number out of its range, played as no action
    ignored_fields: int = 0  # fields that were set although the track has no such action, in all actions
    metrics: dict[str, float] = Field(default_factory=dict)  # by name
    log: str | None = None  # path in the output folder: what its agent printed


class MatchRow(FileModel):
    """One match of an evaluation or a tournament, as it went for one entrant."""

    index: int  # in the suite or in the tournament
    status: str  # of the first of its seats in which something went wrong; "failed": no match
    fault: Fault | None = None  # whose fault it is, if something went wrong
    detail: str = ""  # what went wrong, in one line
    metrics: dict[str, float] | None = None  # the mean of its seats; None if the match has no result
    record: str | None = None  # path in the output folder
    replay: str | None = None  # path in the output folder
    seats: tuple[SeatRow, ...] = ()  # of submissions; empty if the match has no result

    @classmethod
    def of(cls, index: int, seats: tuple[SeatRow, ...], record: str | None) -> Self:
        """Sum up how a match went in each of the entrants' seats, at least one."""
        worst = next((seat for seat in seats if seat.fault is not None), seats[0])
        metrics = mean_metrics([seat.metrics for seat in seats])
        return cls(
            index=index,
            status=worst.status,
            fault=worst.fault,
            detail=worst.detail,
            metrics=metrics,
            record=record,
            seats=seats,
        )

    def of_entrant(self, name: str) -> Self:
        """Return how the match went for one of several entrants."""
        own = tuple(seat for seat in self.seats if seat.submission == name)
        if not own:
            return self  # the match has no result
        return self.of(self.index, own, self.record).model_copy(update={"replay": self.replay})

    @property
    def logs(self) -> tuple[str, ...]:
        """Paths in the output folder: what its agents printed."""
        return tuple(seat.log for seat in self.seats if seat.log is not None)


def mean_metrics(seats: Sequence[dict[str, float]]) -> dict[str, float]:
    """Return each metric's mean over some seats, at least one."""
    # Exact sums, so that the result does not depend on the order of the seats.
    return {name: math.fsum(seat[name] for seat in seats) / len(seats) for name in seats[0]}


class Evaluation(WithOptionalFields):
    """One entrant on one track: a submission, or a robot in a tournament."""

    omitted = ("interface",)

    submission: str
    version: str
    digest: str  # of the submission's folder
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers
    track: str
    metrics: tuple[MetricInfo, ...]  # the first is the score
    matches: tuple[MatchRow, ...]
    summary: dict[str, Summary]  # by metric; empty if no match was played

    @property
    def title(self) -> str:
        """Its name and version, and its interface unless it plays by numbers."""
        return with_interface(f"{self.submission} {self.version}", self.interface)

    @property
    def score(self) -> Summary | None:
        """The metric that ranks, if a match was played."""
        return self.summary.get(self.metrics[0].name)

    @property
    def faults(self) -> int:
        """Matches in which something went wrong."""
        return sum(row.fault is not None for row in self.matches)


def with_interface(name: str, interface: OtherInterface | None) -> str:
    """Return an entrant's name in a table, with its interface unless it plays by numbers."""
    return name if interface is None else f"{name} ({interface})"


def of_clock(clock: object) -> str:
    """Return the end of a title, which names the clock that replaced a suite's own; empty without one."""
    return "" if clock is None else f" · clock {clock}"


class Estimate(FileModel):
    """A value with its bootstrap 95 % interval."""

    value: float
    low: float
    high: float


class Overall(WithOptionalFields):
    """One submission across all tracks of a suite, by scores of which ``random`` has 0 and a reference 1."""

    omitted = ("interface",)

    submission: str
    version: str
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers
    mean: Estimate  # of the tracks' means
    iqm: Estimate  # the mean of the middle half of all matches
    tracks: dict[str, Estimate]  # the mean on each


class SeatTiming(FileModel):
    """How one seat used its time, measured at the engine."""

    seat: int
    start_up: float | None  # s from its agent's start until it was ready; None if it never was
    steps: int  # steps for which it was asked for an action
    late_steps: int  # steps without an answer in time, played with no action
    # Of earlier versions, in which banks paid for waits, too.
    late_for_platform: tuple[int, ...] = Field(default=(), exclude=True)
    credited: float | None = None  # s of waiting for a processor that its bank did not pay; None if unknown
    dropped_actions: int = 0  # answers that arrived after their step was over
    held_steps: int = 0  # steps that were played with its last action, because it thought
    tokens: int = 0  # that its model wrote
    processor: float = 0.0  # s that its threads ran, as far as its sandbox counts them
    time_used: float  # s, of all steps
    latency_p50: float  # s from an observation sent to its answer received
    latency_p99: float  # s
    latency_max: float  # s
    time_bank: float  # s left of it at the end


class MatchTiming(FileModel):
    """How long one match took."""

    submission: str | None  # None in a tournament, where several submissions meet
    track: str
    index: int
    started: float  # s since 1970, UTC
    wall: float  # s, including the start of the agents and writing the record
    steps: int
    seats: tuple[SeatTiming, ...]  # of the submissions
    platform_faults: tuple[str, ...] = ()  # what broke earlier attempts, one line each


class Timings(FileModel):
    """What may differ from run to run."""

    started: str  # ISO 8601, UTC
    wall: float  # s during which a match was played, in all runs together
    jobs: int  # matches at once, in the last run
    matches: tuple[MatchTiming, ...]


class KeptLimits(FileModel):
    """The limits of each agent that its sandbox enforces; None for a limit that it does not."""

    cpus: float | None = None  # cores' worth of processor time
    memory: int | None = None  # bytes, with what is in /tmp
    processes: int | None = None  # processes and threads
    open_files: int | None = None  # of each process
    tmp_size: int | None = None  # bytes in /tmp
    output: int | None = None  # bytes of its output that are kept
    wall_clock: float | None = None  # s, of all steps of a match


class ModelTerms(FileModel):
    """A language model that every seat may ask, and on what terms. See ``model_gateway/settings.py``."""

    name: str
    max_tokens: int  # of an answer
    extra: dict[str, JsonValue] = Field(default_factory=dict)  # more fields of every request
    timeout: float  # s for an answer
    requests: int  # of a seat in a match
    tokens: int  # of prompts and answers, of a seat in a match
    seconds: float  # s that its server works for a seat in a match
    money: float | None = None  # of a seat in a match
    prompt_price: float = 0.0  # of a million tokens of prompts
    answer_price: float = 0.0  # of a million tokens of answers

    def __str__(self) -> str:
        """Return which model it is, in a few words."""
        return f"{self.name} ({self.requests:,} requests and {self.tokens:,} tokens a seat)"


class Results(WithOptionalFields):
    """An evaluation of some submissions on some tracks, or a tournament among them on one track."""

    omitted = ("tournament", "clock", "model", "overall")

    format: Literal[2] = 2
    versions: Versions  # by which it was played
    suite: str  # for an organizer's own, followed by @ and a digest of its file
    seed: int | None  # None while it is hidden
    commitment: str | None = None  # of a hidden seed: SHA-256 of the secret's file
    rounds: Annotated[int, Field(ge=1, le=MAX_ROUNDS)] = 1  # of the suite, each with the next seed
    sandbox: str  # in which agents ran
    limits: dict[str, KeptLimits] = Field(default_factory=dict)  # of each agent in it, by track
    key: str | None = None  # public key of the ledger's signatures, 64 hexadecimal digits
    model: ModelTerms | None = None  # that seats could ask; omitted if there was none
    tournament: TournamentSettings | None = None  # omitted if submissions were evaluated one by one
    clock: ClockChoice | None = None  # of all matches; omitted if they had the suite's own
    evaluations: Annotated[tuple[Evaluation, ...], Field(max_length=MAX_EVALUATIONS)]
    # Of the submissions that played all tracks; omitted where the suite has no scale across tracks.
    overall: Annotated[tuple[Overall, ...], Field(max_length=MAX_EVALUATIONS)] | None = None
    timings: Timings

    @property
    def seed_label(self) -> str:
        """The public part of the seed."""
        return label(self.seed, self.commitment)

    def timings_of(self, evaluation: Evaluation) -> Iterator[MatchTiming]:
        """Yield the timings of an evaluation's matches, each with the submission's own seats alone."""
        own = {row.index: {seat.seat for seat in row.seats} for row in evaluation.matches}
        for timing in self.timings.matches:
            if timing.track == evaluation.track and timing.submission == evaluation.submission:
                yield timing
            elif timing.submission is None and timing.index in own:
                seats = tuple(seat for seat in timing.seats if seat.seat in own[timing.index])
                yield timing.model_copy(update={"seats": seats})

    @property
    def tracks(self) -> tuple[str, ...]:
        """The tracks, in the order of the evaluations."""
        return tuple(dict.fromkeys(evaluation.track for evaluation in self.evaluations))


def read_results(path: Path) -> Results:
    """Read a results file; UserError if it is missing, or none of this version."""
    try:
        return Results.read(path)
    except FileNotFoundError as error:
        raise UserError(f"{path} does not exist") from error
    except FileModelError as error:
        raise UserError(f"{path} is not a results file of format {FORMAT}: {error}") from error


def write_results(results: Results, folder: Path) -> Path:
    """Write ``results.json`` into a folder, whole or not at all, and return its path."""
    return results.write(folder / RESULTS_FILE)
