"""The parts that agents and supply boxes consist of in images.

Each is convex. Those of an agent lie within the cylinder that collisions and shots use: legs, a torso in the
colour of its team, a helmet with a dark visor, a rifle and a pack. They show which way the agent faces.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind, write_plane
from wildscav_engine.rendering.palette import SUPPLY_BOX, of_seat
from wildscav_engine.rendering.tracing.solids import Solids

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


@lru_cache(maxsize=8)
def colors_of_bodies(teams: int) -> NDArray[np.float64]:
    """Return (T, P, 3) the colours of the body parts of each team."""
    colors = np.array([of_seat(team) for team in range(teams)], np.float64)[:, None]
    return np.asarray(BODY_COLORS + (colors - BODY_COLORS) * TEAM_SHARE[:, None])


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
def write_object(
    kind: int,
    shapes: NDArray[np.float64],
    place: tuple[float, float, float],
    yaw: float,
    owner: int,
    first: int,
    solids: Solids,
) -> None:
    """Write the parts of an object.

    Args:
        kind: The ``Kind`` of the object.
        shapes: (P, 10) m, its parts, as in ``BODY``.
        place: m, where it stands.
        yaw: Degrees, its direction.
        owner: The seat whose body it is, or NO_OWNER.
        first: The index of the first part to write.
        solids: The parts; P of them are written.
    """
    turn = (sine(yaw), cosine(yaw))
    for shape in range(shapes.shape[0]):
        part = first + shape
        solids.kind[part], solids.owner[part] = kind, owner
        _write_corners(shapes[shape], place, turn, part, solids)
        _write_faces(part, solids)


@inlined_kernel
def _write_corners(
    shape: NDArray[np.float64],
    place: tuple[float, float, float],
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
