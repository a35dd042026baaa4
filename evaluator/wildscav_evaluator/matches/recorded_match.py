"""A recorded match with the agent asked again: whether it acts as it is recorded to have acted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav.wire.actions import ACTION_FIELDS
from wildscav_engine.record import Record
from wildscav_engine.simulation.match import Match


@dataclass
class Agreement:
    """How far one seat's agent acted as recorded."""

    seat: int
    steps: int = 0  # that were compared
    differing: int = 0  # of those, the steps with another action than recorded
    first: int | None = None  # the first of those, counted from 1
    recorded: NDArray[np.float32] | None = None  # (FIELDS,), the action recorded at that step
    now: NDArray[np.float32] | None = None  # (FIELDS,), the one that the agent gives there now

    @property
    def difference(self) -> str:
        """The first difference, in a line; nothing if there is none."""
        if self.recorded is None or self.now is None:
            return ""
        fields = ", ".join(
            f"{name} {_number(was)} recorded, {_number(now)} now"
            for name, was, now in zip(ACTION_FIELDS, self.recorded, self.now, strict=True)
            if was != now
        )
        if not self.recorded.any():
            return f"{fields} (no action is recorded there: the agent may have been late)"
        return fields if self.now.any() else f"{fields} (it gave no action now, or too late)"


class RecordedMatch(Match):
    """A match that is played by its record, whatever its agents do now; their answers are compared with it.

    So every agent sees at each step just what there was to see in the match recorded, also once it has acted
    otherwise.

    Args:
        record: The record.
        seats: Whose actions to compare.
    """

    def __init__(self, record: Record, seats: Sequence[int]) -> None:
        super().__init__(record.spec)
        self._record = record
        self.agreements = {seat: Agreement(seat) for seat in seats}
        self.diverged_at: int | None = None  # the first step, from 1, whose state is not that recorded

    def step(self, actions: ArrayLike | None = None) -> None:
        """Compare actions with those recorded, and play the latter.

        Args:
            actions: (A, FIELDS), of the agents now; None for no action of anyone.
        """
        number = self.step_number
        if self.over or number >= self._record.steps:
            super().step()
            return
        recorded = self._record.actions[number]
        now = np.zeros_like(recorded) if actions is None else np.asarray(actions, np.float32)
        for seat, agreement in self.agreements.items():
            _compare(agreement, number + 1, recorded[seat], now[seat])
        super().step(recorded)
        if self.diverged_at is None and self.digest != self._record.digests[number]:
            self.diverged_at = number + 1


def _compare(
    agreement: Agreement, step: int, recorded: NDArray[np.float32], now: NDArray[np.float32]
) -> None:
    agreement.steps += 1
    if np.array_equal(recorded, now):
        return
    agreement.differing += 1
    if agreement.first is None:
        agreement.first, agreement.recorded, agreement.now = step, recorded.copy(), now.copy()


def _number(value: float) -> str:
    """Return a 32-bit number so that no other one reads the same."""
    return f"{value:.9g}"
