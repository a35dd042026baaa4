"""Re-simulation of records, for verification, scoring and replays."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps import GENERATOR_VERSION, MapError, map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record.format import Record, RecordError
from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.specs.thinking import Account, SeatThinking, held
from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION, advice

Fault = tuple[int | None, str]  # the step, counted from 1, and what is wrong with it, in a line


class Verification(NamedTuple):
    """The result of verifying a record: whether it holds, and if not, the first difference."""

    holds: bool
    step: int | None  # the first step that differs, counted from 1; None if no step does
    message: str  # one line


def resimulate(record: Record, game_map: GameMap | None = None) -> Iterator[Match]:
    """Play the actions of a record again, on its map if given, except that robots decide anew.

    Yields the same match object, before the first step and after each step of the record.

    Raises:
        RecordError: The match cannot be set up, or its map is not the one on which it was played.
    """
    # Checked before generating the map, which may take long or fail with a less helpful error.
    if record.simulation_version != SIMULATION_VERSION:
        raise RecordError(
            f"played with simulation version {record.simulation_version}, but this engine has "
            f"version {SIMULATION_VERSION}: {advice(record.engine_version)}"
        )
    if record.generator_version != GENERATOR_VERSION:
        raise RecordError(
            f"played on a map of generator version {record.generator_version}, but this engine has "
            f"version {GENERATOR_VERSION}: {advice(record.engine_version)}"
        )
    try:
        match = Match(record.spec, game_map if game_map is not None else map_of(record.spec.map))
    except (MapError, MatchSetupError) as error:
        raise RecordError(f"the match cannot be set up: {error}") from None
    if match.game_map.digest != record.map_digest:
        raise RecordError(
            f"played on map {record.map_digest}, but this engine ({ENGINE_VERSION}; the record's is "
            f"{record.engine_version}) generates map {match.game_map.digest} from the same spec"
        )
    yield match
    for actions in record.actions:
        match.step(actions)
        yield match


def verify_record(record: Record, game_map: GameMap | None = None) -> Verification:
    """Re-simulate a record and compare the actions and the digest of every step, and the result."""
    try:
        matches = resimulate(record, game_map)
        match = next(matches)
        for step in range(1, record.steps + 1):
            was_over = match.over
            next(matches)
            if was_over:
                return Verification(False, step, f"step {step} comes after the match is over")
            # Bytes, because -0.0 equals 0.0 and NaN does not equal itself.
            if match.actions_played[-1].tobytes() != record.actions[step - 1].tobytes():
                return Verification(False, step, f"step {step}: an action differs from the one played")
            if match.digest != record.digests[step - 1]:
                return Verification(False, step, f"step {step}: the state differs")
    except RecordError as error:
        return Verification(False, None, str(error))
    if fault := charge_fault(record):
        return Verification(False, *fault)
    if match.result() != record.result:
        return Verification(False, None, "the result differs from that of the match")
    if not match.over:
        return Verification(False, None, f"ends after step {record.steps}, before the match is over")
    return Verification(True, None, f"holds: {record.steps} steps")


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
