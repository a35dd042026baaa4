"""The server's reports on a match: how each seat's process behaved."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match


class Fault(StrEnum):
    """Whose fault it is that a match did not run as it should."""

    AGENT = "agent"
    PLATFORM = "platform"


class SeatStatus(StrEnum):
    """How a seat's part in the match ended. All but the first two end it early: no action from then on."""

    FINISHED = "finished"
    TIMED_OUT = "timed_out"  # its time bank was used up; late steps were played with no action
    CRASHED = "crashed"  # its process or its stream ended before the match did
    OUT_OF_MEMORY = "out_of_memory"  # its host ended it because it used too much memory
    PROTOCOL_ERROR = "protocol_error"  # it violated the protocol
    OVER_BUDGET = "over_budget"  # it asked its model for more than its budget allowed
    DISQUALIFIED = "disqualified"  # its host ended it because it exceeded another limit
    NEVER_JOINED = "never_joined"  # it was not ready before the end of its start-up time

    @property
    def fault(self) -> Fault | None:
        """Whose fault it is, if any. Failures of the platform are not outcomes of seats: the match fails."""
        return None if self == SeatStatus.FINISHED else Fault.AGENT


class ThinkTime(NamedTuple):
    """Time from sending an observation to receiving its answer, s, measured at the engine."""

    total: float = 0.0
    p50: float = 0.0
    p99: float = 0.0
    max: float = 0.0

    @classmethod
    def of(cls, times: Sequence[float]) -> "ThinkTime":
        """Return the statistics of the times of all steps, s."""
        if not times:
            return cls()
        p50, p99 = np.percentile(np.asarray(times), (50, 99)).tolist()
        return cls(float(sum(times)), p50, p99, float(max(times)))


NO_TIME = ThinkTime()


@dataclass(slots=True)
class Conduct:
    """A seat's outcome and the counts of its answers."""

    status: SeatStatus = SeatStatus.FINISHED
    detail: str = ""
    steps_played: int = 0
    late_steps: int = 0
    dropped_actions: int = 0
    invalid_actions: int = 0
    ignored_fields: int = 0


@dataclass(frozen=True, slots=True)
class SeatReport:
    """How one seat's process behaved."""

    seat: int
    status: SeatStatus
    detail: str = ""  # the reason for the status, in a line
    exit_code: int | None = None  # of a process that ended early, if its host knows it
    killed_by: str = ""  # the signal that ended it, such as SIGKILL
    last_lines: tuple[str, ...] = ()  # the last lines that such a process printed
    steps_played: int = 0  # steps with an answer in time
    late_steps: int = 0  # steps without one, while the seat was still in the match
    dropped_actions: int = 0  # answers to steps that were over
    invalid_actions: int = 0  # answers with a number out of range, played as no action
    ignored_fields: int = 0  # fields set outside the track's action set, in all actions together
    think_time: ThinkTime = NO_TIME
    time_bank: float = 0.0  # remaining time bank, s
    start_up: float | None = None  # s from its start until it was ready; None if it never was
    credited: float | None = None  # s of waiting for a processor that its bank did not pay; None if unknown
    tokens: int = 0  # that its model wrote
    processor: float = 0.0  # s that its threads ran in the match, as far as its host counts them
    held_steps: int = 0  # steps that were played with its last action, because it thought


@dataclass(frozen=True, slots=True)
class MatchOutcome:
    """A finished match and how its seats behaved."""

    match: "Match"
    seats: dict[int, SeatReport] = field(default_factory=dict)  # of the submission seats
    seconds: float = 0.0  # wall time of the steps
