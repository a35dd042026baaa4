"""The parts that agents and supply boxes consist of in images.

Each is convex. Those of an agent lie within the cylinder that collisions and shots use: legs, a torso in the
colour of its team, a helmet with a dark visor, a rifle and a pack. They show which way the agent faces.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind
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
# The weight of the team's colour in the colour of each part.
TEAM_SHARE = np.array([0.30, 0.30, 1.0, 0.75, 0.0, 0.0, 0.45])
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


class Parts(NamedTuple):
    """The P parts of an object that stands at the origin and looks north."""

    corners: NDArray[np.float64]  # (P, 8, 3) m, numbered by the bits (along, up, across)
    faces: NDArray[np.float64]  # (P, 6, 4) see ``Solids``: bottom, top, left, right, back, front
    boxes: NDArray[np.float64]  # (P, 9) see ``Shapes``


def parts_of(shapes: NDArray[np.float64]) -> Parts:
    """Return the parts with (P, 10) shapes, as in ``BODY``."""
    bits = np.arange(CORNERS)
    across, up, along = bits & 1, bits >> 1 & 1, bits >> 2
    columns = np.stack([5 * up + 1 + 2 * across, 5 * up, 5 * up + 2 + 2 * along], axis=1)
    corners = shapes[:, columns]  # (P, 8, 3)
    a, b, c = (corners[:, which] for which in zip(*THREE_OF_FACE, strict=True))  # (P, 6, 3) each
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    behind = corners.mean(axis=1)[:, None]
    normals *= np.sign(((a - behind) * normals).sum(axis=-1, keepdims=True))
    faces = np.concatenate([normals, (a * normals).sum(axis=-1, keepdims=True)], axis=-1)
    low, high = corners.min(axis=1), corners.max(axis=1)
    half = (high - low) / 2
    boxes = np.zeros((len(shapes), 9))
    boxes[:, :3], boxes[:, 3], boxes[:, 4] = (high + low) / 2, np.linalg.norm(half, axis=1), half[:, 1]
    boxes[:, 5], boxes[:, 8] = half[:, 0], half[:, 2]
    return Parts(*map(np.ascontiguousarray, (corners, faces, boxes)))


# Three corners of each face.
THREE_OF_FACE = ((0, 1, 4), (2, 3, 6), (0, 2, 4), (1, 3, 5), (0, 1, 2), (4, 5, 6))
BODY_PARTS, CRATE_PARTS = parts_of(BODY), parts_of(CRATE)


@kernel
def write_object(
    kind: int,
    parts: Parts,
    place: tuple[float, float, float],
    yaw: float,
    owner: int,
    first: int,
    solids: Solids,
    boxes: NDArray[np.float64],
) -> None:
    """Write the parts of an object of some ``Kind`` that stands at a place, m, with a yaw in degrees.

    They are the solids from index ``first`` on, with their boxes (S, 9), as in ``Shapes``. The owner is the
    seat whose body it is, or NO_OWNER.
    """
    turn = (sine(yaw), cosine(yaw))
    for part in range(parts.boxes.shape[0]):
        index = first + part
        solids.kind[index], solids.owner[index] = kind, owner
        _write_corners(parts.corners[part], place, turn, index, solids)
        _write_faces(parts.faces[part], place, turn, solids.faces[FACES * index : FACES * (index + 1)])
        _write_box(parts.boxes[part], place, turn, boxes[index])


@inlined_kernel
def _turned(x: float, z: float, turn: tuple[float, float]) -> tuple[float, float]:
    """Return x and z of a vector that is turned to the right by an angle with some sine and cosine."""
    return x * turn[1] + z * turn[0], z * turn[1] - x * turn[0]


@inlined_kernel
def _write_corners(
    corners: NDArray[np.float64],
    place: tuple[float, float, float],
    turn: tuple[float, float],
    index: int,
    solids: Solids,
) -> None:
    """Write the corners of a part and its bounding box along the axes."""
    low_x, low_z, high_x, high_z = np.inf, np.inf, -np.inf, -np.inf
    for corner in range(CORNERS):
        x, z = _turned(corners[corner, 0], corners[corner, 2], turn)
        at = solids.corners[CORNERS * index + corner]
        at[0], at[1], at[2] = place[0] + x, place[1] + corners[corner, 1], place[2] + z
        low_x, high_x = min(low_x, at[0]), max(high_x, at[0])
        low_z, high_z = min(low_z, at[2]), max(high_z, at[2])
    low, high = solids.low[index], solids.high[index]
    low[0], low[1], low[2] = low_x, place[1] + corners[0, 1], low_z
    high[0], high[1], high[2] = high_x, place[1] + corners[2, 1], high_z


@inlined_kernel
def _write_faces(
    faces: NDArray[np.float64],
    place: tuple[float, float, float],
    turn: tuple[float, float],
    written: NDArray[np.float64],
) -> None:
    """Write the faces of a part."""
    for face in range(FACES):
        x, z = _turned(faces[face, 0], faces[face, 2], turn)
        y, plane = faces[face, 1], written[face]
        plane[0], plane[1], plane[2] = x, y, z
        plane[3] = faces[face, 3] + (x * place[0] + y * place[1] + z * place[2])


@inlined_kernel
def _write_box(
    box: NDArray[np.float64],
    place: tuple[float, float, float],
    turn: tuple[float, float],
    written: NDArray[np.float64],
) -> None:
    """Write the bounding box of a part that is turned with it."""
    x, z = _turned(box[0], box[2], turn)
    written[0], written[1], written[2] = place[0] + x, place[1] + box[1], place[2] + z
    written[3], written[4] = box[3], box[4]
    written[5], written[6] = _turned(box[5], box[6], turn)
    written[7], written[8] = _turned(box[7], box[8], turn)
