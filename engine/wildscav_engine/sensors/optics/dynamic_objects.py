"""The dynamic objects of a match as images show them: living agents and supply boxes.

Each consists of a few convex parts; see ``object_parts.py``.
"""

import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.compilation.passed_tables import ADDRESS, LENGTH
from wildscav_engine.compilation.tables.array_tables import Addresses, addresses_of, bytes_at, reader
from wildscav_engine.compilation.tables.row_copy import row_size
from wildscav_engine.rendering.dynamic_objects import (
    DynamicObjects,
    ObjectArrays,
    ObjectSets,
    addresses_of_new,
    read_objects,
    solids_between,
)
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.rendering.tracing.solids import NO_OWNER, Solids
from wildscav_engine.sensors.optics.object_parts import (
    AGENT,
    BODY,
    BODY_PARTS,
    BOX,
    CRATE,
    CRATE_COLORS,
    CRATE_PARTS,
    FACES,
    allocate_parts,
    colors_of_bodies,
    write_object,
)
from wildscav_engine.simulation.batch_kernels import agents_of, supplies_of
from wildscav_engine.simulation.state import Agents, Matches, State, Supplies, allocate_state, matches_at
from wildscav_engine.simulation.systems.supplies import is_present

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

BOX_YAW_STEP = 137.5  # degrees between the yaws of successive boxes, so that they do not line up
DIFFERENT = -1  # in place of an index
INVINCIBLE_WHITE = 0.5  # weight of white in the colours of an invincible agent
Position = tuple[float, float, float]  # m, on the ground
read_parts = reader(BODY_PARTS)
BODY_TABLE, CRATE_TABLE = addresses_of(BODY_PARTS), addresses_of(CRATE_PARTS)


def dynamic_objects_of(match: "MatchView") -> DynamicObjects:
    """Return the living agents of a match and its present boxes; the owner of a body is its seat.

    They are made once for a state, and must not be changed.
    """
    # All sensors and agents of a step ask for the same objects, one after another.
    state = match.state
    agents, supplies, matches = state.tables
    if not _is_kept(agents.addresses, supplies.addresses, matches.addresses, latest.kept):
        latest.kept = NOTHING_KEPT  # in case what follows is interrupted
        latest.objects = dynamic_objects_in(state)
        latest.kept = _shown_bytes(state)
    return latest.objects


def dynamic_objects_in(state: State) -> DynamicObjects:
    """Return the same objects, of the state of a match, and make them anew."""
    return DynamicObjects.of(objects_of_matches(state))


NOTHING_KEPT = np.zeros(0, np.uint8)


class Latest(threading.local):
    """The objects that each thread made last, and the bytes of all that they depend on."""

    def __init__(self) -> None:
        self.kept = NOTHING_KEPT
        self.objects: DynamicObjects


latest = Latest()


# What of a state the objects depend on: indices of the arrays.
SHOWN_OF_AGENTS = tuple(
    Agents._fields.index(name) for name in ("present", "health", "team", "invincible_left", "position", "yaw")
)
SHOWN_OF_SUPPLIES = tuple(
    Supplies._fields.index(name) for name in ("position", "quantity", "appears", "serial")
)
SHOWN_OF_MATCHES = (Matches._fields.index("frame"),)


def _shown_bytes(state: State) -> NDArray[np.uint8]:
    """Return the bytes of all that the objects depend on."""
    parts = zip(state, (SHOWN_OF_AGENTS, SHOWN_OF_SUPPLIES, SHOWN_OF_MATCHES), strict=True)
    every = [part[index].tobytes() for part, indices in parts for index in indices]
    return np.frombuffer(bytearray(b"".join(every)), np.uint8)


@kernel
def _is_kept(agents: Addresses, supplies: Addresses, matches: Addresses, kept: NDArray[np.uint8]) -> bool:
    """Return whether all that the objects depend on is as it was when its bytes were kept."""
    first = _end_of_same(agents, SHOWN_OF_AGENTS, kept, 0)
    first = _end_of_same(supplies, SHOWN_OF_SUPPLIES, kept, first)
    first = _end_of_same(matches, SHOWN_OF_MATCHES, kept, first)
    return bool(first == kept.shape[0])


@inlined_kernel
def _end_of_same(table: Addresses, fields: tuple[int, ...], kept: NDArray[np.uint8], first: int) -> int:
    """Return where the bytes of some arrays of one match end in those kept, or DIFFERENT."""
    for field in fields:
        size = row_size(table, field)
        if first == DIFFERENT or first + size > kept.shape[0]:
            return DIFFERENT
        now, before = bytes_at(table[field, ADDRESS], size), kept[first : first + size]
        changed = np.uint8(0)
        for index in range(size):
            changed = np.uint8(changed | (now[index] ^ before[index]))  # in eight bits, so many at a time
        if changed != 0:
            return DIFFERENT
        first += size
    return first


def objects_of_matches(state: State, room: ObjectSets | None = None) -> ObjectSets:
    """Return the living agents and the present boxes of all matches, each as ``dynamic_objects_of`` does.

    The parts are in the order of the matches, in each those of agents first.

    The new objects take the place of those in ``room``, which nobody needs anymore, if they fit in: the parts
    of many boxes are megabytes, and fresh memory takes longer than writing them.
    """
    agents, supplies, matches = (table.addresses for table in state.tables)
    start = np.zeros(len(state.matches.frame) + 1, np.int64)
    most = _count_parts(agents, supplies, matches, start)
    count = int(start[-1])
    if room is not None and count <= len(room.arrays.kind):
        arrays, addresses = room.arrays, room.addresses
    else:
        arrays = _allocate(count if room is None else count + count // 4)
        addresses = addresses_of_new(arrays)
    body_colors = colors_of_bodies(int(state.agents.team.max(initial=0)) + 1)
    _write_objects(agents, supplies, matches, BODY_TABLE, CRATE_TABLE, body_colors, addresses)
    return ObjectSets(arrays, start, most, FACES if count else 0, addresses)


def _allocate(count: int) -> ObjectArrays:
    shapes = np.empty((count, 9)), np.empty(count, np.int64)
    return ObjectArrays(*allocate_parts(count), *shapes, np.empty((count, 3)), np.empty(count, np.int32))


@inlined_kernel
def _shown_in(agents: Addresses, supplies: Addresses, match: int) -> tuple[Agents, Supplies]:
    """Return the agents and the boxes of one match."""
    bodies = agents_of(agents, match, agents[0, LENGTH])
    return bodies, supplies_of(supplies, match, supplies[0, LENGTH])


@kernel
def _count_parts(agents: Addresses, supplies: Addresses, matches: Addresses, start: NDArray[np.int64]) -> int:
    """Write where the parts of each match start; return the number of the match that has most."""
    every, most = matches_at(matches), 0
    for match in range(start.shape[0] - 1):
        bodies, boxes = _shown_in(agents, supplies, match)
        count = 0
        for seat in range(bodies.present.shape[0]):
            if _is_shown(bodies, seat):
                count += BODY.shape[0]
        for slot in range(boxes.quantity.shape[0]):
            if is_present(boxes, slot, every.frame[match]):
                count += CRATE.shape[0]
        start[match + 1], most = start[match] + count, max(most, count)
    return most


@kernel
def _write_objects(
    agents: Addresses,
    supplies: Addresses,
    matches: Addresses,
    body: Addresses,
    crate: Addresses,
    body_colors: NDArray[np.float64],
    objects: Addresses,
) -> None:
    """Write the parts of everything in all matches, given the tables of their state and of the parts."""
    every, arrays, first = matches_at(matches), read_objects(objects), 0
    of_body, of_crate = read_parts(body), read_parts(crate)
    solids = solids_between(arrays, 0, arrays.kind.shape[0])
    for match in range(every.frame.shape[0]):
        bodies, boxes = _shown_in(agents, supplies, match)
        for seat in range(bodies.present.shape[0]):
            if _is_shown(bodies, seat):
                place = bodies.position[seat]
                spot = (place[0], place[1], place[2])
                write_object(AGENT, of_body, spot, bodies.yaw[seat], seat, first, solids, arrays.obbs)
                white = INVINCIBLE_WHITE if bodies.invincible_left[seat] > 0 else 0.0
                _paint(body_colors[bodies.team[seat]], white, seat, first, arrays.color, arrays.instance)
                first += BODY.shape[0]
        for slot in range(boxes.quantity.shape[0]):
            if is_present(boxes, slot, every.frame[match]):
                at = boxes.position[slot]
                spot = (np.float64(at[0]), np.float64(at[1]), np.float64(at[2]))
                serial = boxes.serial[slot]
                write_object(BOX, of_crate, spot, BOX_YAW_STEP * serial, NO_OWNER, first, solids, arrays.obbs)
                _paint(CRATE_COLORS, 0.0, serial, first, arrays.color, arrays.instance)
                first += CRATE.shape[0]
    for part in range(first):
        arrays.names[part] = arrays.owner[part]


@inlined_kernel
def _is_shown(bodies: Agents, seat: int) -> bool:
    """Return whether a seat has a living agent."""
    return bool(bodies.present[seat] and bodies.health[seat] > 0)


@inlined_kernel
def _paint(
    own: NDArray[np.float64],
    white: float,
    number: int,
    first: int,
    color: NDArray[np.float64],
    instance: NDArray[np.int32],
) -> None:
    """Write the instance number and the (P, 3) own colours of an object's parts, with some white in them."""
    for part in range(own.shape[0]):
        instance[first + part] = number
        for channel in range(3):
            color[first + part, channel] = own[part, channel] + (255.0 - own[part, channel]) * white


def as_dynamic_objects(solids: Solids) -> DynamicObjects:
    """Return dynamic objects unchanged, and other solids with the colour of their owner or of supply boxes.

    The instance number of such a solid is its owner, or its own index if it has none.
    """
    if isinstance(solids, DynamicObjects):
        return solids
    owned = solids.owner != NO_OWNER
    color = np.tile(CRATE_COLORS[0], (len(solids.kind), 1))
    color[owned] = [of_seat(seat) for seat in solids.owner[owned].tolist()] or np.zeros((0, 3))
    instance = np.where(owned, solids.owner, np.arange(len(solids.kind)))
    return DynamicObjects(solids, instance.astype(np.int32), color)


def placed_objects(agents: Sequence[tuple[Position, float]], boxes: Sequence[Position]) -> DynamicObjects:
    """Return agents and boxes as images show them.

    Args:
        agents: The position and the yaw in degrees of each agent; each is in a team of its own.
        boxes: The position of each box.
    """
    state = allocate_state(1, len(agents), len(boxes))
    state.agents.present[:], state.agents.health[:] = True, 1
    state.agents.team[0] = np.arange(len(agents))
    state.agents.position[0] = np.array([place for place, _ in agents]).reshape(-1, 3)
    state.agents.yaw[0] = [yaw for _, yaw in agents]
    state.supplies.quantity[:], state.supplies.serial[0] = 1, np.arange(len(boxes))
    state.supplies.position[0] = np.array(boxes).reshape(-1, 3)
    return dynamic_objects_in(state)
