"""What the server reports of a match: how each seat's process behaved."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match


class Fault(StrEnum):
    """Whose fault it is if a match did not go as it should."""

    AGENT = "agent"
    PLATFORM = "platform"


class SeatStatus(StrEnum):
    """How a seat's part in the match ended. All but the first two end it early: no action from then on."""

    FINISHED = "finished"
    TIMED_OUT = "timed_out"  # its time bank was used up; late steps were played with no action
    CRASHED = "crashed"  # its process or its stream ended before the match did
    OUT_OF_MEMORY = "out_of_memory"  # its host ended it for the memory that it took
    PROTOCOL_ERROR = "protocol_error"  # it sent what no agent may send
    DISQUALIFIED = "disqualified"  # its host ended it for another limit that it broke
    NEVER_JOINED = "never_joined"  # its time to start up was over, and it had not taken its seat

    @property
    def fault(self) -> Fault | None:
        """Whose fault it is, if any. What the platform breaks is no seat's outcome: the match fails."""
        return None if self == SeatStatus.FINISHED else Fault.AGENT


class ThinkTime(NamedTuple):
    """Time from sending an observation to receiving its answer, s, measured at the engine."""

    total: float = 0.0
    p50: float = 0.0
    p99: float = 0.0
    max: float = 0.0

    @classmethod
    def of(cls, times: Sequence[float]) -> "ThinkTime":
        """Sum up the times of all steps."""
        if not times:
            return cls()
        p50, p99 = np.percentile(np.asarray(times), (50, 99)).tolist()
        return cls(float(sum(times)), p50, p99, float(max(times)))


NO_TIME = ThinkTime()


class SlowAnswer(NamedTuple):
    """One answer that took longer than the budget; late steps may lie within it."""

    step: int  # that was to be answered
    asked: float  # by the monotonic clock, s
    answered: float  # of an answer that never came, when the last step was played


@dataclass(slots=True)
class Conduct:
    """What is counted of a seat's behaviour while it plays."""

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
    detail: str = ""  # why, in a line
    exit_code: int | None = None  # of a process that ended early, where its host knows it
    killed_by: str = ""  # the signal that ended it, such as SIGKILL
    last_lines: tuple[str, ...] = ()  # of what such a process printed
    steps_played: int = 0  # with an answer in time
    late_steps: int = 0  # without one, while the seat was still in the match
    dropped_actions: int = 0  # answers to steps that were over
    invalid_actions: int = 0  # with a number out of its range, played as no action
    ignored_fields: int = 0  # set outside the track's action set, in all actions together
    think_time: ThinkTime = NO_TIME
    time_bank: float = 0.0  # s left of it
    start_up: float | None = None  # s from its start until it was ready; none if it never was
    late: tuple[int, ...] = ()  # numbers of the late steps
    slow_answers: tuple[SlowAnswer, ...] = ()  # the answers that took longer than the budget, in order


@dataclass(frozen=True, slots=True)
class MatchOutcome:
    """A finished match and how its seats behaved."""

    match: "Match"
    seats: dict[int, SeatReport] = field(default_factory=dict)  # of the submission seats
    seconds: float = 0.0  # wall time of the steps
