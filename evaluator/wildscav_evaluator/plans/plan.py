"""What the plans of evaluations and of tournaments share."""

import time
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Self

from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.output.identity import Entrant, Identity
from wildscav_evaluator.output.numbered_folders import own_folder
from wildscav_evaluator.output.results import (
    CURRENT_VERSIONS,
    Evaluation,
    KeptLimits,
    MatchRow,
    MatchTiming,
    MetricInfo,
    ModelTerms,
    Results,
    Timings,
    of_clock,
)
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, KEPT_ANYWHERE, Limits
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import Suite


@dataclass(frozen=True, kw_only=True)
class Plan(ABC):
    """Everything that defines a run of matches: what is played, where, and into which folder."""

    submissions: tuple[Submission, ...]
    suite: Suite
    seed: SuiteSeed
    replays: str  # "none", "first" or "all"
    jobs: int  # matches at once
    out: Path
    fresh: bool = False  # whether another evaluation in the output folder is removed
    rounds: int = 1
    sandbox: str = "process"  # the name of the sandbox in which agents run
    key: SigningKey | None = None  # the key that signs the ledger
    model: ModelSettings | None = None  # that agents may ask

    @property
    @abstractmethod
    def title(self) -> str:
        """A short description of what is played."""

    @abstractmethod
    def identity(self) -> Identity:
        """Return everything that the results depend on."""

    @abstractmethod
    def make_jobs(self) -> list[Job]:
        """Return the matches to play, sorted by map, so that a map is rarely generated twice.

        UserError if they cannot be played.
        """

    @abstractmethod
    def collect(self, done: Iterable[JobResult]) -> Results:
        """Return the results of all matches; the order in which they were played does not matter."""

    @property
    def matches_of(self) -> str:
        """The suite of its matches, with their clock if that is not the suite's, in a few words."""
        return f"suite {self.suite.label}{of_clock(self.suite.clock)}"

    @property
    def public_key(self) -> str | None:
        """The public half of the key, 64 hexadecimal digits."""
        return None if self.key is None else self.key.public

    def conditions(self, tracks: Iterable[str]) -> dict[str, Any]:
        """Return what the identity and the results of a run on some tracks both name."""
        return {
            "versions": CURRENT_VERSIONS,
            "suite": self.suite.label,
            "commitment": self.seed.commitment,
            "rounds": self.rounds,
            "sandbox": self.sandbox,
            "limits": self.kept_limits(tracks),
            "key": self.public_key,
            "clock": self.suite.clock,
            "model": None if self.model is None else ModelTerms.about(self.model),
        }

    def in_own_folder(self) -> Self:
        """Return this plan with a numbered output folder inside its output folder."""
        return replace(self, out=own_folder(self.out, self.identity(), fresh=self.fresh))

    def limits(self, track: str) -> Limits:
        """Return the limits of an agent on a track."""
        return self.suite.limits.get(track, DEFAULT_LIMITS)

    def kept_limits(self, tracks: Iterable[str]) -> dict[str, KeptLimits]:
        """Return the limits that the sandbox enforces, by track."""
        kept = None if SANDBOXES[self.sandbox].isolated else KEPT_ANYWHERE
        return {track: KeptLimits(**self.limits(track).model_dump(include=kept)) for track in tracks}

    def is_rendered(self, index: int) -> bool:
        """Return whether a match is rendered as a replay."""
        return self.replays == "all" or (self.replays == "first" and index == 0)

    def timings(self, done: Iterable[JobResult]) -> Timings:
        """Return the timings of matches, in the order in which they are given."""
        matches = [result.timing for result in done if result.timing is not None]
        first = min((timing.started for timing in matches), default=time.time())
        return Timings(
            started=datetime.fromtimestamp(first, UTC).isoformat(timespec="seconds"),
            wall=_covered(matches),
            jobs=self.jobs,
            matches=tuple(matches),
        )


def evaluation_of(
    one: Submission | Entrant,
    version: str,
    track: str,
    metrics: tuple[MetricInfo, ...],
    rows: Iterable[MatchRow],
) -> Evaluation:
    """Return what the matches of a submission, or of an entrant, on a track add up to."""
    matches = tuple(_in_order(row, [metric.name for metric in metrics]) for row in rows)
    return Evaluation(
        submission=one.name,
        version=version,
        digest=one.digest,
        interface=one.interface,
        track=track,
        metrics=metrics,
        matches=matches,
        summary=summary(metrics, matches),
    )


def _in_order(row: MatchRow, names: Sequence[str]) -> MatchRow:
    """Return a row with its metrics in the given order; the ledger, from which it may come, sorts them."""

    def ordered(values: dict[str, float]) -> dict[str, float]:
        return {name: values[name] for name in (*names, *values) if name in values}

    seats = tuple(seat.model_copy(update={"metrics": ordered(seat.metrics)}) for seat in row.seats)
    metrics = None if row.metrics is None else ordered(row.metrics)
    return row.model_copy(update={"metrics": metrics, "seats": seats})


def _covered(matches: Sequence[MatchTiming]) -> float:
    """Return the total time during which a match was played, s; overlaps count once."""
    total, until = 0.0, 0.0
    for start, end in sorted((one.started, one.started + one.wall) for one in matches):
        total += max(0.0, end - max(start, until))
        until = max(until, end)
    return total
