"""The dynamic objects of a match as images show them: living agents and supply boxes.

Each consists of a few convex parts. Those of an agent lie within the cylinder that collisions and shots use:
legs, a torso in the colour of its team, a helmet with a dark visor, a rifle and a pack. They show which way
the agent faces.
"""

import threading
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind, write_plane
from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.rendering.palette import SUPPLY_BOX, of_seat
from wildscav_engine.rendering.tracing.solids import NO_OWNER, Solids
from wildscav_engine.simulation.state import Agents, State, Supplies
from wildscav_engine.simulation.systems.supplies import is_present

FACES, CORNERS = 6, 8  # of a part
AGENT, BOX = int(Kind.AGENT), int(Kind.SUPPLY_BOX)

# A part is a box that may taper. Each row has the height, left, back, right and front of its bottom, then the
# same of its top. All are in m from the point between the soles, to the right and along the view.
BODY = np.array(
    [
        [0.00, -0.27, -0.15, -0.05, 0.21, 0.86, -0.25, -0.15, -0.02, 0.14],  # left leg
        [0.00, 0.05, -0.15, 0.27, 0.21, 0.86, 0.02, -0.15, 0.25, 0.14],  # right leg
        [0.80, -0.26, -0.17, 0.26, 0.16, 1.46, -0.38, -0.19, 0.38, 0.19],  # torso
        [1.46, -0.15, -0.17, 0.15, 0.14, 1.78, -0.12, -0.14, 0.12, 0.12],  # helmet
        [1.54, -0.12, 0.10, 0.12, 0.18, 1.67, -0.12, 0.10, 0.12, 0.17],  # visor
        [1.16, 0.06, 0.00, 0.15, 0.42, 1.29, 0.06, 0.00, 0.15, 0.42],  # rifle
        [0.92, -0.20, -0.37, 0.20, -0.16, 1.40, -0.22, -0.34, 0.22, -0.16],  # pack
    ]
)
LEGS = (52, 54, 60)
BODY_COLORS = np.array(
    [LEGS, LEGS, (0, 0, 0), (40, 42, 46), (16, 18, 24), (34, 34, 38), (58, 56, 50)], np.float64
)
TEAM_SHARE = np.array(
    [0.30, 0.30, 1.0, 0.75, 0.0, 0.0, 0.45]
)  # weight of the team's colour in the colour of each part
# A crate reaches a little into the ground, which may be sloped. Its band protrudes from its sides.
CRATE = np.array(
    [
        [-0.10, -0.28, -0.28, 0.28, 0.28, 0.44, -0.30, -0.30, 0.30, 0.30],  # crate
        [0.44, -0.33, -0.33, 0.33, 0.33, 0.56, -0.31, -0.31, 0.31, 0.31],  # lid
        [-0.10, -0.07, -0.31, 0.07, 0.31, 0.58, -0.07, -0.34, 0.07, 0.34],  # band
    ]
)
CRATE_COLORS = np.array([SUPPLY_BOX, (206, 240, 255), (30, 74, 128)], np.float64)
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
        slots = Supplies(*(array[0] for array in supplies))
        latest.state, latest.objects = state, _make_objects(agents, slots, match.frame)
    return latest.objects


class Latest(threading.local):
    """The objects that each thread made last, and everything of the state that they depend on."""

    def __init__(self) -> None:
        self.state: tuple[object, ...] = ()
        self.objects: DynamicObjects


latest = Latest()


def _make_objects(agents: Agents, supplies: Supplies, frame: int) -> DynamicObjects:
    seats = np.nonzero(agents.present[0] & (agents.health[0] > 0))[0]
    slots = np.empty(len(supplies.quantity), np.int64)
    slots = slots[: _find_boxes(supplies, frame, slots)]
    bodies, crates = len(seats) * len(BODY), len(slots) * len(CRATE)
    solids = allocate_parts(bodies + crates)
    write_parts(AGENT, BODY, agents.position[0], agents.yaw[0], seats, 0, solids)
    yaws = BOX_YAW_STEP * supplies.serial.astype(np.float64)
    write_parts(BOX, CRATE, supplies.position.astype(np.float64), yaws, slots, bodies, solids)
    instance, color = np.empty(bodies + crates, np.int32), np.empty((bodies + crates, 3))
    teams, invincible_left = agents.team[0], agents.invincible_left[0]
    body_colors = colors_of_bodies(int(teams.max(initial=0)) + 1)
    _write_agent_colors(seats, body_colors, teams, invincible_left, instance[:bodies], color[:bodies])
    _write_box_colors(supplies.serial, slots, instance[bodies:], color[bodies:])
    return DynamicObjects(solids, instance, color)


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


@lru_cache(maxsize=8)
def colors_of_bodies(teams: int) -> NDArray[np.float64]:
    """Return (T, P, 3) the colours of the body parts of each team."""
    colors = np.array([of_seat(team) for team in range(teams)], np.float64)[:, None]
    return np.asarray(BODY_COLORS + (colors - BODY_COLORS) * TEAM_SHARE[:, None])


@kernel
def _write_agent_colors(
    seats: NDArray[np.int64],
    body_colors: NDArray[np.float64],
    teams: NDArray[np.int32],
    invincible_left: NDArray[np.int32],
    instance: NDArray[np.int32],
    color: NDArray[np.float64],
) -> None:
    """Write the seat and the colour of each part of some agents, from the (T, P, 3) colours of teams."""
    parts = body_colors.shape[1]
    for part in range(instance.shape[0]):
        seat = seats[part // parts]
        instance[part] = seat
        white = INVINCIBLE_WHITE if invincible_left[seat] > 0 else 0.0
        for channel in range(3):
            own = body_colors[teams[seat], part % parts, channel]
            color[part, channel] = own + (255.0 - own) * white


@kernel
def _write_box_colors(
    serials: NDArray[np.int32],
    slots: NDArray[np.int64],
    instance: NDArray[np.int32],
    color: NDArray[np.float64],
) -> None:
    """Write the serial number and the colour of each part of some boxes."""
    parts = CRATE_COLORS.shape[0]
    for part in range(instance.shape[0]):
        instance[part] = serials[slots[part // parts]]
        for channel in range(3):
            color[part, channel] = CRATE_COLORS[part % parts, channel]


@kernel
def _find_boxes(supplies: Supplies, frame: int, slots: NDArray[np.int64]) -> int:
    count = 0
    for slot in range(supplies.quantity.shape[0]):
        if is_present(supplies, slot, frame):
            slots[count] = slot
            count += 1
    return count


def allocate_parts(count: int) -> Solids:
    """Return arrays for ``count`` parts."""
    return Solids(
        np.empty(count, np.int8),
        np.empty(count, np.int32),
        np.empty((count, 3)),
        np.empty((count, 3)),
        np.arange(count + 1, dtype=np.int64) * FACES,
        np.empty((count * FACES, 4)),
        np.arange(count + 1, dtype=np.int64) * CORNERS,
        np.empty((count * CORNERS, 3)),
    )


@kernel
def write_parts(
    kind: int,
    shapes: NDArray[np.float64],
    places: NDArray[np.float64],
    yaws: NDArray[np.float64],
    rows: NDArray[np.int64],
    first: int,
    solids: Solids,
) -> None:
    """Write the parts of some objects of the same shape.

    Args:
        kind: The ``Kind`` of the objects.
        shapes: (P, 10) m, the parts of each object, as in ``BODY``.
        places: (A, 3) m, the positions of all objects of this kind.
        yaws: (A,) degrees, their directions.
        rows: (N,) the indices of the objects to write; agents own their bodies.
        first: The index of the first part to write.
        solids: The parts; N * P of them are written.
    """
    part = first
    for index in rows:
        turn = (sine(yaws[index]), cosine(yaws[index]))
        for shape in range(shapes.shape[0]):
            solids.kind[part], solids.owner[part] = kind, index if kind == AGENT else NO_OWNER
            _write_corners(shapes[shape], places[index], turn, part, solids)
            _write_faces(part, solids)
            part += 1


@inlined_kernel
def _write_corners(
    shape: NDArray[np.float64],
    place: NDArray[np.float64],
    turn: tuple[float, float],
    part: int,
    solids: Solids,
) -> None:
    """Write the corners of a part, numbered by the bits (along, up, across), and its bounding box."""
    low, high = solids.low[part], solids.high[part]
    for corner in range(8):
        side = 5 * (corner >> 1 & 1)
        across, along = shape[side + 1 + 2 * (corner & 1)], shape[side + 2 + 2 * (corner >> 2)]
        at = solids.corners[solids.corner_start[part] + corner]
        at[0] = place[0] + across * turn[1] + along * turn[0]
        at[1] = place[1] + shape[side]
        at[2] = place[2] - across * turn[0] + along * turn[1]
        for axis in range(3):
            low[axis] = at[axis] if corner == 0 else min(low[axis], at[axis])
            high[axis] = at[axis] if corner == 0 else max(high[axis], at[axis])


@inlined_kernel
def _write_faces(part: int, solids: Solids) -> None:
    """Write the faces of a part: bottom, top, left, right, back, front."""
    corner, face = solids.corner_start[part], solids.face_start[part]
    behind = (
        0.5 * (solids.low[part, 0] + solids.high[part, 0]),
        0.5 * (solids.low[part, 1] + solids.high[part, 1]),
        0.5 * (solids.low[part, 2] + solids.high[part, 2]),
    )
    corners, faces = solids.corners, solids.faces
    faces[face] = (0.0, -1.0, 0.0, -corners[corner, 1])
    faces[face + 1] = (0.0, 1.0, 0.0, corners[corner + 2, 1])
    write_plane(corners[corner], corners[corner + 2], corners[corner + 4], behind, faces[face + 2])
    write_plane(corners[corner + 1], corners[corner + 3], corners[corner + 5], behind, faces[face + 3])
    write_plane(corners[corner], corners[corner + 1], corners[corner + 2], behind, faces[face + 4])
    write_plane(corners[corner + 4], corners[corner + 5], corners[corner + 6], behind, faces[face + 5])
