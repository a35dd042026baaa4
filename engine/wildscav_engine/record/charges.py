"""Verification of what seats were charged for thinking, in matches whose clock is ``tokens``."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.record.format import Record
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.specs.thinking import Account, held

Fault = tuple[int | None, str]  # the step, counted from 1, and what is wrong with it, in a line


def charge_fault(record: Record) -> Fault | None:
    """Return how the charges of a record differ from its spec's price, or its actions from what they held.

    A charge is made in the step of the observation that was thought about. It lasts its number of steps, in
    which the seat's last action holds. Then the answer takes effect, and the seat is asked again.
    """
    if record.thinking is None or not len(record.thinking.charges):
        return None
    charges, spec = record.thinking.charges, record.spec
    if spec.clock != "tokens":
        return None, f"seats are charged for thinking, but the clock is {spec.clock}"
    if charges.min() < 0:
        return None, "a charge is negative"
    for seat in np.unique(charges[:, 0]).tolist():
        if seat >= len(spec.seats) or spec.seats[seat] != SUBMISSION:
            return None, f"seat {seat} is charged for thinking, but no agent fills it"
        fault = _fault_of_seat(record, seat, charges[charges[:, 0] == seat])
        if fault is not None:
            return fault
    return None


def _fault_of_seat(record: Record, seat: int, charges: NDArray[np.int64]) -> Fault | None:
    account = Account(record.spec.thinking, record.spec.frames_per_action)
    actions, free = record.actions[:, seat], 0  # the first step in which the seat may be asked
    for _, step, tokens, processor, steps in charges.tolist():
        if not free <= step < record.steps:
            return step + 1, f"step {step + 1}: seat {seat} is charged, but it was not asked"
        due = account.charge(tokens, processor)
        if steps != due:
            return (
                step + 1,
                f"step {step + 1}: seat {seat} is charged {steps} steps, and its thought costs {due}",
            )
        fault = _fault_of_held(actions, step, steps)
        if fault is not None:
            return (
                fault + 1,
                f"step {fault + 1}: the last action of seat {seat} does not hold while it thinks",
            )
        free = step + steps + 1 if steps else step + 1
    return None


def _fault_of_held(actions: NDArray[np.float32], step: int, steps: int) -> int | None:
    """Return the first of some steps in which a seat's last action does not hold; None if it always does.

    A seat that leaves the match meanwhile does nothing from then on.
    """
    last = held(actions[step - 1]) if step else np.zeros_like(actions[0])
    for number in range(step, min(step + steps, len(actions))):
        if actions[number].tobytes() != last.tobytes():
            return number if actions[number:].any() else None
    return None
