"""Snapshots: the state of one match as bytes, from which it can continue later or elsewhere.

The bytes have the layout of ``storage/binary_format.py``. The payload holds the part of each state array that
the match uses, without padding. If the snapshot is of a ``Match``, the actions and digests so far follow.
Random numbers have no state, because they are functions of the seed and the frame. The checksum detects
damage but not forgery: do not load states from untrusted sources.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from wildscav_engine.compilation.passed_tables import ITEM, LENGTH
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.compilation.tables.row_copy import copy_row
from wildscav_engine.maps import GENERATOR_VERSION, GameMap, MapError, map_of
from wildscav_engine.simulation.state import Agents, Extent, Matches, Supplies, axes_of
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.binary_format import BinaryFormatError, Layout, pack, unpack
from wildscav_engine.version import SIMULATION_VERSION

LAYOUT = Layout(b"WILDSNAP", 2, "a state of a match")
VERSIONS = {"simulation_version": SIMULATION_VERSION, "generator_version": GENERATOR_VERSION}


class StateError(ValueError):
    """A match cannot continue from some bytes; the message is one line that says why."""


class History(NamedTuple):
    """The actions and digests of the steps played."""

    actions: NDArray[np.float32]  # (T, A, FIELDS)
    digests: NDArray[np.uint64]  # (T,)


# The numbers of seats, slots for boxes, phases of the zone, places of the hot spot, and waves of supplies.
Counts = tuple[int, int, int, int, int]


class Snapshot(NamedTuple):
    """The decoded bytes of a state."""

    spec: MatchSpec
    map_digest: str
    counts: Counts
    content: NDArray[np.uint8]  # (N,) the parts of all arrays that the match uses
    history: History | None


# (F,) the Extent of each array, for each part of a batch. What agents see is computed anew.
EXTENTS = (
    *(
        np.array([axes.extent for _, axes in axes_of(kind).values()], np.int64)
        for kind in (Agents, Supplies, Matches)
    ),
    np.full(len(Seen._fields), Extent.NOTHING),
)


def sizes_of(tables: Sequence[Addresses], counts: Counts) -> list[NDArray[np.int64]]:
    """Return (F,) the bytes in a row of each array that belong to a match, for each part of a batch."""
    sizes = []
    for table, kinds in zip(tables, EXTENTS, strict=True):
        lengths = np.choose(kinds, [*counts, table[:, LENGTH], 0])
        sizes.append(table[:, ITEM] * table[:, LENGTH + 1 :].prod(axis=1) * lengths)
    return sizes


def encode(
    spec: MatchSpec,
    game_map: GameMap,
    tables: Sequence[Addresses],
    row: int,
    counts: Counts,
    history: History | None,
) -> bytes:
    """Return a match of a batch as bytes, with the actions and digests so far if they are known."""
    sizes = sizes_of(tables, counts)
    content = np.empty(sum(int(part.sum()) for part in sizes), np.uint8)
    _copy(tables, row, sizes, content, writes=False)
    header = {
        **VERSIONS,
        "spec": spec.model_dump(mode="json"),
        "map_digest": game_map.digest,
        "counts": counts,
        "size": len(content),
        "steps": None if history is None else len(history.digests),
    }
    parts = [content, *(history or ())]
    return pack(LAYOUT, header, *(part.reshape(-1).view(np.uint8).data for part in parts))


def decode(data: bytes) -> Snapshot:
    """Decode the bytes of a state; StateError if they are not a state of these versions, or damaged."""
    try:
        header, payload = unpack(LAYOUT, data)
    except BinaryFormatError as error:
        raise StateError(f"the state is {error}") from None
    for name, wanted in VERSIONS.items():
        if header.get(name) != wanted:
            word = name.replace("_", " ")
            raise StateError(f"the state is of {word} {header.get(name)}; this engine has {wanted}")
    try:
        spec = MatchSpec.model_validate(header["spec"])
        size, steps, counts = header["size"], header["steps"], header["counts"]
    except ValidationError as error:
        raise StateError(f"the state's spec is not valid: {one_line(error)}") from None
    except KeyError as error:
        raise StateError(f"the state's header has no {error}") from None
    try:
        content = np.frombuffer(payload, np.uint8, size).copy()
        history = None if steps is None else _history(payload[size:], steps, len(spec.seats))
        seats, slots, phases, places, waves = counts
    except (TypeError, ValueError) as error:
        raise StateError(f"the state's payload does not fit its header: {error}") from None
    if seats != len(spec.seats):
        raise StateError(f"the state is of {seats} seats, but its spec has {len(spec.seats)}")
    return Snapshot(spec, header["map_digest"], (seats, slots, phases, places, waves), content, history)


def _history(payload: memoryview, steps: int, seats: int) -> History:
    count = steps * seats * FIELDS
    actions = np.frombuffer(payload, np.float32, count).reshape(steps, seats, FIELDS)
    digests = np.frombuffer(payload[actions.nbytes :], np.uint64, steps)
    return History(actions.copy(), digests.copy())


def check_size(snapshot: Snapshot, tables: Sequence[Addresses]) -> None:
    """Refuse a snapshot whose size differs from that of this engine's states.

    The size does not depend on the capacity of the batch, so it may be checked before the batch grows.
    """
    sizes = sizes_of(tables, snapshot.counts)
    if sum(int(part.sum()) for part in sizes) != len(snapshot.content):
        raise StateError("the state is of another build of this engine: its arrays have other sizes")


def write(snapshot: Snapshot, tables: Sequence[Addresses], row: int) -> None:
    """Write a snapshot of checked size into a row that is cleared and large enough."""
    _copy(tables, row, sizes_of(tables, snapshot.counts), snapshot.content, writes=True)


def _copy(
    tables: Sequence[Addresses],
    row: int,
    sizes: Sequence[NDArray[np.int64]],
    content: NDArray[np.uint8],
    *,
    writes: bool,
) -> None:
    first = 0
    for table, of_part in zip(tables, sizes, strict=True):
        last = first + int(of_part.sum())
        copy_row(table, row, of_part, content[first:last], writes)
        first = last


def map_for(snapshot: Snapshot, known: Sequence[GameMap]) -> GameMap:
    """Return the map of a snapshot, which is generated if it is not among the known maps."""
    for game_map in known:
        if game_map.digest == snapshot.map_digest:
            return game_map
    try:
        game_map = map_of(snapshot.spec.map)
    except MapError as error:
        raise StateError(f"the map of the state cannot be generated: {error}") from None
    if game_map.digest != snapshot.map_digest:
        raise StateError(
            f"the state is on map {snapshot.map_digest}, but its spec generates {game_map.digest} here"
        )
    return game_map
