"""Verification of what records say of thinking, and of what seats were charged for it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.record.format import Record
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.specs.thinking import Account, SeatThinking, held

Fault = tuple[int | None, str]  # the step, counted from 1, and what is wrong with it, in a line


def charge_fault(record: Record) -> Fault | None:
    """Return how what a record says of thinking differs from its spec or from its actions.

    A charge is made in the step of the observation that was thought about. It lasts its number of steps, in
    which the seat's last action holds. Then the answer takes effect, and the seat is asked again.
    """
    spec, thinking = record.spec, record.thinking
    filled = [number for number, seat in enumerate(spec.seats) if seat == SUBMISSION]
    if thinking is None:
        return (None, "how much agents thought is missing") if filled and spec.clock == "tokens" else None
    charges = thinking.charges
    if len(charges) and spec.clock != "tokens":
        return None, f"seats are charged for thinking, but the clock is {spec.clock}"
    if (charges < 0).any():
        return None, "a charge is negative"
    if others := sorted({*charges[:, 0].tolist()}.difference(filled)):
        return None, f"seat {others[0]} is charged for thinking, but no agent fills it"
    faults = (_fault_of_seat(record, one, charges[charges[:, 0] == one.seat]) for one in thinking.seats)
    return next(filter(None, faults), None)


def _fault_of_seat(record: Record, told: SeatThinking, charges: NDArray[np.int64]) -> Fault | None:
    seat, spec = told.seat, record.spec
    account = Account(spec.thinking, spec.frames_per_action)
    actions, free = record.actions[:, seat], 0  # the first step in which the seat may be asked
    least = most = paid = 0  # steps that it must and may have held, and tokens
    for _, step, tokens, processor, steps in charges.tolist():
        which = f"step {step + 1}: seat {seat} is charged"
        if not free <= step < record.steps:
            return step + 1, f"{which}, but it was not asked"
        due = account.charge(tokens, processor)
        if steps != due:
            return step + 1, f"{which} {steps} steps, and its thought costs {due}"
        fault = _fault_of_held(actions, step, steps)
        if fault is not None:
            return fault, f"step {fault}: the last action of seat {seat} does not hold while it thinks"
        free, paid = step + steps + 1 if steps else step + 1, paid + tokens
        end = min(step + steps, record.steps)
        least, most = most, most + end - step
        if actions[end - 1 :].any():  # it has not left meanwhile
            least = most
    if told.tokens < paid:
        return None, f"seat {seat} is charged for {paid} tokens, but wrote {told.tokens}"
    if spec.clock != "running" and not least <= told.held <= most:
        return None, f"seat {seat} is said to have held {told.held} steps, but held {most}"
    return None


def _fault_of_held(actions: NDArray[np.float32], step: int, steps: int) -> int | None:
    """Return the first step, from 1, in which a seat's last action does not hold; None if it always does.

    A seat that leaves the match meanwhile does nothing from then on.
    """
    last = held(actions[step - 1]) if step else np.zeros_like(actions[0])
    for number in range(step, min(step + steps, len(actions))):
        if actions[number].tobytes() != last.tobytes():
            return number + 1 if actions[number:].any() else None
    return None
