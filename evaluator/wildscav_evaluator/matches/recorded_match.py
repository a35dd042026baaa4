"""A recorded match in which agents run again, to compare their actions with those recorded."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav.agent import ACTION_FIELDS
from wildscav_engine.record import Record
from wildscav_engine.simulation.match import Match


@dataclass
class Agreement:
    """The comparison of one seat's actions with those recorded."""

    seat: int
    steps: int = 0  # steps compared
    differing: int = 0  # steps with another action than recorded
    first: int | None = None  # the first differing step, counted from 1
    recorded: NDArray[np.float32] | None = None  # (FIELDS,), the action recorded at that step
    now: NDArray[np.float32] | None = None  # (FIELDS,), the agent's new action at that step

    @property
    def difference(self) -> str:
        """The first difference in one line; an empty text if there is none."""
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
    """A match that plays the recorded actions and compares the agents' new actions with them.

    So every agent observes at each step exactly what it observed in the recorded match, even after it has
    acted differently.
    """

    def __init__(self, record: Record, seats: Sequence[int]) -> None:
        super().__init__(record.spec)
        self._record = record
        self.seeds = dict(enumerate(record.seeds))
        self.agreements = {seat: Agreement(seat) for seat in seats}
        self.diverged_at: int | None = None  # the first step, from 1, with another state than recorded

    def step(self, actions: ArrayLike | None = None) -> None:
        """Compare the agents' new actions, (A, FIELDS), with the recorded ones, which are played."""
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
    """Return a 32-bit float as text that no other 32-bit float shares."""
    return f"{value:.9g}"
