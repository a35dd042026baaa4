"""The record of a match: its spec and every action, small and exact.

The file has the layout of ``storage/binary_format.py``. Its compressed payload holds the actions, (T, A,
FIELDS) float32, then the digests, (T,) uint64, then what seats were charged for thinking, (C, CHARGE) int64.
The checksum detects damage but not forgery. Forgery is detected by ``verify_record``, which re-simulates the
match.
"""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.setup.match_setup import seed_of_seat
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.result import MatchResult
from wildscav_engine.specs.thinking import CHARGE, SeatThinking, Thinking
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.binary_format import BinaryFormatError, Layout, decompress, pack, unpack
from wildscav_engine.storage.files import read_limited, write_whole
from wildscav_engine.version import ENGINE_VERSION, SIMULATION_VERSION

RECORD_VERSION = 3  # of the payload and of the header
WITHOUT_SEEDS = 2  # the version whose header lacks the seeds, which then follow from the spec
LAYOUT = Layout(b"WILDSCAV", RECORD_VERSION, "a record of a match", WITHOUT_SEEDS)
ARRAYS_LIMIT = 128 << 20  # bytes when decompressed, which bounds the memory of a reader
FILE_LIMIT = ARRAYS_LIMIT + (2 << 20)  # bytes: the header, and arrays that do not compress
HEADER_KEYS = {
    *("spec", "map_digest", "generator_version", "simulation_version", "engine_version"),
    *("names", "seeds", "result", "steps"),
}
SUFFIX = ".wsr"


class RecordError(Exception):
    """A record cannot be read; the message says which file, what is wrong and where."""


class _Thought(Spec):
    """How much seats thought, as a header has it."""

    seats: tuple[SeatThinking, ...]
    charges: Annotated[int, Field(ge=0)]  # how many


@dataclass(frozen=True, eq=False)
class Record:
    """A recorded match."""

    spec: MatchSpec
    map_digest: str
    generator_version: int  # of the maps
    simulation_version: int  # of the rules
    engine_version: str
    names: tuple[str, ...]  # display names, one for each seat
    seeds: tuple[int, ...]  # the private seed that each seat was told
    result: MatchResult
    actions: NDArray[np.float32]  # (T, A, FIELDS) as played, including those of robots
    digests: NDArray[np.uint64]  # (T,) of the state after each step
    thinking: Thinking | None = None  # how much its seats thought; None if it was not measured
    version: int = RECORD_VERSION  # of the file that it was read from

    @property
    def steps(self) -> int:
        """Steps played."""
        return len(self.digests)


def record_of(match: Match, names: Sequence[str]) -> Record:
    """Return the record of a match so far, with the display names of its seats."""
    return Record(
        spec=match.spec,
        map_digest=match.game_map.digest,
        generator_version=GENERATOR_VERSION,
        simulation_version=SIMULATION_VERSION,
        engine_version=ENGINE_VERSION,
        names=tuple(names),
        seeds=tuple(match.start_info(seat).seed for seat in range(match.seats)),
        result=match.result(),
        actions=np.array(match.actions_played, np.float32).reshape(-1, match.seats, FIELDS),
        digests=np.array(match.digests, np.uint64),
        thinking=match.thinking,
    )


def write_record(path: Path, match: Match, names: Sequence[str]) -> None:
    """Write the record of a match atomically; OSError if that is impossible."""
    save(record_of(match, names), path)


def check_recordable(spec: MatchSpec) -> None:
    """Refuse a match whose record could exceed the size that readers accept.

    Raises:
        RecordError: It could.
    """
    steps, seats = spec.step_limit, len(spec.seats)
    size = sum(_array_bytes(steps, seats, steps * seats if spec.clock == "tokens" else 0))
    if size > ARRAYS_LIMIT:
        raise RecordError(
            f"a match of {spec.step_limit:,} steps with {len(spec.seats):,} seats has a record of up to "
            f"{size >> 20:,} MiB, {ARRAYS_LIMIT >> 20} are allowed: reduce its time limit or its seats"
        )


def save(record: Record, path: Path) -> None:
    """Write a record atomically; OSError if that is impossible."""
    write_whole(path, encode(record))


def encode(record: Record) -> bytes:
    """Return a record as bytes. Equal records give equal bytes."""
    header = {
        "spec": record.spec.model_dump(mode="json"),
        "map_digest": record.map_digest,
        "generator_version": record.generator_version,
        "simulation_version": record.simulation_version,
        "engine_version": record.engine_version,
        "names": list(record.names),
        "seeds": list(record.seeds),
        "result": record.result.model_dump(mode="json"),
        "steps": record.steps,
    }
    arrays = record.actions.astype("<f4").tobytes() + record.digests.astype("<u8").tobytes()
    if record.thinking is not None:
        seats, charges = record.thinking
        header["thinking"] = {"seats": [one.model_dump() for one in seats], "charges": len(charges)}
        arrays += charges.astype("<i8").tobytes()
    return pack(LAYOUT, header, zlib.compress(arrays, 6))


def read_record(path: Path) -> Record:
    """Read a record.

    Raises:
        RecordError: The file is missing, not a record, of another format version, truncated or damaged.
    """
    try:
        data = read_limited(path, FILE_LIMIT)
    except OSError as error:
        raise RecordError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return decode(data)
    except RecordError as error:
        raise RecordError(f"{path}: {error}") from None


def decode(data: bytes) -> Record:
    """Return the record that ``encode`` turned into bytes.

    Raises:
        RecordError: The bytes are not a valid record; the message says why.
    """
    try:
        return _assemble(*unpack(LAYOUT, data))
    except BinaryFormatError as error:
        raise RecordError(str(error)) from None
    except ValidationError as error:
        raise RecordError(f"its header is not valid: {one_line(error)}") from None
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError, zlib.error) as error:
        raise RecordError(f"its contents are not valid: {error}") from None


def _assemble(header: dict[str, Any], packed: memoryview) -> Record:
    """Build a record from header and payload, and check that they are consistent."""
    header.setdefault("simulation_version", 1)  # the first version wrote no number
    version = RECORD_VERSION if "seeds" in header else WITHOUT_SEEDS
    if {*header, "seeds"} - {"thinking"} != HEADER_KEYS:
        raise ValueError(f"its header has the keys {sorted(header)}, must have {sorted(HEADER_KEYS)}")
    spec = MatchSpec.model_validate(header["spec"])
    steps, seats = int(header["steps"]), len(spec.seats)
    seeds = header.get("seeds", [seed_of_seat(spec, seat) for seat in range(seats)])
    if len(seeds) != seats or any(type(seed) is not int or not 0 <= seed < 1 << 63 for seed in seeds):
        raise ValueError(f"its seeds are {seeds}, must be {seats} whole numbers from 0 to 2^63 - 1")
    names = tuple(str(name) for name in header["names"])
    if len(names) != seats:
        raise ValueError(f"{len(names)} names for {seats} seats")
    if not 0 <= steps <= spec.step_limit:
        raise ValueError(f"{steps} steps, but the match has at most {spec.step_limit}")
    told = _Thought.model_validate(header["thinking"]) if "thinking" in header else None
    filled = [number for number, seat in enumerate(spec.seats) if seat == SUBMISSION]
    if told is not None and [one.seat for one in told.seats] != filled:
        raise ValueError(f"its thinking is not that of the seats {filled}, which agents fill")
    sizes = _array_bytes(steps, seats, 0 if told is None else told.charges)
    if sum(sizes) > ARRAYS_LIMIT:
        raise ValueError(f"its arrays would have {sum(sizes)} bytes, {ARRAYS_LIMIT} are allowed")
    arrays, action_bytes = decompress(packed, sum(sizes)), sizes[0]
    actions = np.frombuffer(arrays, "<f4", action_bytes // 4).reshape(steps, seats, FIELDS)
    charges = np.frombuffer(arrays, "<i8", offset=action_bytes + sizes[1]).reshape(-1, len(CHARGE))
    return Record(
        spec=spec,
        map_digest=str(header["map_digest"]),
        generator_version=int(header["generator_version"]),
        simulation_version=int(header["simulation_version"]),
        engine_version=str(header["engine_version"]),
        names=names,
        seeds=tuple(seeds),
        result=MatchResult.model_validate(header["result"]),
        actions=actions.astype(np.float32, copy=False),
        digests=np.frombuffer(arrays, "<u8", steps, action_bytes).astype(np.uint64, copy=False),
        thinking=None if told is None else Thinking(told.seats, charges.astype(np.int64, copy=False)),
        version=version,
    )


def _array_bytes(steps: int, seats: int, charges: int) -> tuple[int, int, int]:
    """Return the sizes in bytes of a record's actions, digests and charges."""
    return steps * seats * FIELDS * 4, steps * 8, charges * len(CHARGE) * 8
