"""Re-simulation of records, for verification, scoring and replays."""

from collections.abc import Iterator
from typing import NamedTuple

from wildscav_engine.maps import GENERATOR_VERSION, MapError, map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record.charges import charge_fault
from wildscav_engine.record.format import Record, RecordError
from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION, advice


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
