"""The dynamic objects of a match as images show them: living agents and supply boxes.

Each consists of a few convex parts; see ``object_parts.py``.
"""

import threading
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
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
from wildscav_engine.simulation.state import Agents, State, Supplies
from wildscav_engine.simulation.systems.supplies import is_present

BOX_YAW_STEP = 137.5  # degrees between the yaws of successive boxes, so that they do not line up
INVINCIBLE_WHITE = 0.5  # weight of white in the colours of an invincible agent


class DrawableMatch(Protocol):
    """What images need to know about a match: its present state."""

    @property
    def state(self) -> State:
        """The state, with a leading axis of length one."""

    @property
    def frame(self) -> int:
        """Frames played so far."""


def dynamic_objects_of(match: DrawableMatch) -> DynamicObjects:
    """Return the living agents of a match and its present boxes; the owner of a body is its seat.

    They are made once for a state, and must not be changed.
    """
    agents, supplies = match.state.agents, match.state.supplies
    # All sensors and agents of a step ask for the same objects, one after another.
    state = (
        match.frame,
        agents.present.tobytes(),
        agents.health.tobytes(),
        agents.team.tobytes(),
        agents.position.tobytes(),
        agents.yaw.tobytes(),
        agents.invincible_left.tobytes(),
        supplies.position.tobytes(),
        supplies.quantity.tobytes(),
        supplies.appears.tobytes(),
        supplies.serial.tobytes(),
    )
    if latest.state != state:
        latest.state, latest.objects = state, _make_objects(agents, supplies, match.frame)
    return latest.objects


class Latest(threading.local):
    """The objects that each thread made last, and everything of the state that they depend on."""

    def __init__(self) -> None:
        self.state: tuple[object, ...] = ()
        self.objects: DynamicObjects


latest = Latest()


def _make_objects(agents: Agents, supplies: Supplies, frame: int) -> DynamicObjects:
    arrays, instance, _ = _gather(_bodies_of(agents), supplies, np.array([frame]))
    return DynamicObjects.of(arrays, instance)


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
