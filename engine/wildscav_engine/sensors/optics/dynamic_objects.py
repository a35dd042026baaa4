"""The dynamic objects of a match as images show them: living agents and supply boxes.

Each consists of a few convex parts; see ``object_parts.py``.
"""

import threading
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses, bytes_at
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.compilation.row_copy import row_size
from wildscav_engine.compilation.table_columns import ADDRESS
from wildscav_engine.rendering.dynamic_objects import (
    DynamicObjects,
    ObjectArrays,
    ObjectSets,
    solids_between,
)
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.rendering.tracing.solids import NO_OWNER, Solids, write_boxes
from wildscav_engine.sensors.optics.object_parts import (
    AGENT,
    BODY,
    BOX,
    CRATE,
    CRATE_COLORS,
    allocate_parts,
    colors_of_bodies,
    write_object,
)
from wildscav_engine.simulation.state import Agents, Matches, State, Supplies
from wildscav_engine.simulation.systems.supplies import is_present

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

BOX_YAW_STEP = 137.5  # degrees between the yaws of successive boxes, so that they do not line up
DIFFERENT = -1  # in place of an index
INVINCIBLE_WHITE = 0.5  # weight of white in the colours of an invincible agent


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
    arrays, instance, _ = _gather(_bodies_of(state.agents), state.supplies, state.matches.frame)
    return DynamicObjects.of(arrays, instance)


NOTHING_KEPT = np.zeros(0, np.uint8)


class Latest(threading.local):
    """The objects that each thread made last, and the bytes of all that they depend on."""

    def __init__(self) -> None:
        self.kept = NOTHING_KEPT
        self.objects: DynamicObjects


latest = Latest()


def objects_of_matches(state: State) -> ObjectSets:
    """Return the living agents and the present boxes of all matches, each as ``dynamic_objects_of`` does."""
    arrays, _, start = _gather(_bodies_of(state.agents), state.supplies, state.matches.frame)
    return ObjectSets(arrays, start)


class Bodies(NamedTuple):
    """What images show of the agents of B matches, (B, A) each; see ``Agents``."""

    present: NDArray[np.bool_]
    health: NDArray[np.int32]
    team: NDArray[np.int32]
    invincible_left: NDArray[np.int32]
    position: NDArray[np.float64]  # (B, A, 3)
    yaw: NDArray[np.float64]


# What of a state the objects depend on: indices of the arrays.
SHOWN_OF_AGENTS = tuple(Agents._fields.index(name) for name in Bodies._fields)
SHOWN_OF_SUPPLIES = tuple(map(Supplies._fields.index, ("position", "quantity", "appears", "serial")))
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


def _bodies_of(agents: Agents) -> Bodies:
    return Bodies(
        agents.present, agents.health, agents.team, agents.invincible_left, agents.position, agents.yaw
    )


def _gather(
    bodies: Bodies, supplies: Supplies, frames: NDArray[np.int64]
) -> tuple[ObjectArrays, NDArray[np.int32], NDArray[np.int64]]:
    """Return the parts of what is in B matches.

    Args:
        bodies: Of B matches.
        supplies: Of B matches.
        frames: (B,) frames that each has played.

    Returns:
        The parts, match after match, those of agents first; (S,) their instances; and (B + 1,) where the
        parts of each match start.
    """
    start = np.zeros(len(frames) + 1, np.int64)
    _count_parts(bodies, supplies, frames, start)
    count = int(start[-1])
    shapes = np.empty((count, 9)), np.empty(count, np.int64)
    arrays = ObjectArrays(*allocate_parts(count), *shapes, np.empty((count, 3)))
    instance = np.empty(count, np.int32)
    body_colors = colors_of_bodies(int(bodies.team.max(initial=0)) + 1)
    _write_objects(bodies, supplies, frames, body_colors, arrays, instance)
    return arrays, instance, start


@kernel
def _count_parts(
    bodies: Bodies, supplies: Supplies, frames: NDArray[np.int64], start: NDArray[np.int64]
) -> None:
    """Write where the parts of each match start."""
    for match in range(frames.shape[0]):
        count = 0
        for seat in range(bodies.present.shape[1]):
            if _is_shown(bodies, match, seat):
                count += BODY.shape[0]
        boxes = _boxes_of(supplies, match)
        for slot in range(boxes.quantity.shape[0]):
            if is_present(boxes, slot, frames[match]):
                count += CRATE.shape[0]
        start[match + 1] = start[match] + count


@kernel
def _write_objects(
    bodies: Bodies,
    supplies: Supplies,
    frames: NDArray[np.int64],
    body_colors: NDArray[np.float64],
    arrays: ObjectArrays,
    instance: NDArray[np.int32],
) -> None:
    """Write the parts of everything in B matches.

    Args:
        bodies: Of B matches.
        supplies: Of B matches.
        frames: (B,) frames that each has played.
        body_colors: As of ``colors_of_bodies``.
        arrays: S parts, written.
        instance: (S,) written.
    """
    solids, first = solids_between(arrays, 0, instance.shape[0]), 0
    for match in range(frames.shape[0]):
        for seat in range(bodies.present.shape[1]):
            if _is_shown(bodies, match, seat):
                place = bodies.position[match, seat]
                spot = (place[0], place[1], place[2])
                write_object(AGENT, BODY, spot, bodies.yaw[match, seat], seat, first, solids)
                white = INVINCIBLE_WHITE if bodies.invincible_left[match, seat] > 0 else 0.0
                _paint(body_colors[bodies.team[match, seat]], white, seat, first, arrays.color, instance)
                first += BODY.shape[0]
        boxes = _boxes_of(supplies, match)
        for slot in range(boxes.quantity.shape[0]):
            if is_present(boxes, slot, frames[match]):
                at = boxes.position[slot]
                spot = (np.float64(at[0]), np.float64(at[1]), np.float64(at[2]))
                serial = boxes.serial[slot]
                write_object(BOX, CRATE, spot, BOX_YAW_STEP * serial, NO_OWNER, first, solids)
                _paint(CRATE_COLORS, 0.0, serial, first, arrays.color, instance)
                first += CRATE.shape[0]
    write_boxes(solids.faces, solids.face_start, solids.corners, solids.corner_start, arrays.boxes)
    for part in range(first):
        arrays.names[part] = arrays.owner[part]


@inlined_kernel
def _is_shown(bodies: Bodies, match: int, seat: int) -> bool:
    """Return whether a seat has a living agent."""
    return bool(bodies.present[match, seat] and bodies.health[match, seat] > 0)


@inlined_kernel
def _boxes_of(supplies: Supplies, match: int) -> Supplies:
    """Return the supply boxes of one match."""
    return Supplies(
        supplies.position[match],
        supplies.quantity[match],
        supplies.appears[match],
        supplies.serial[match],
        supplies.next_in_square[match],
    )


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
