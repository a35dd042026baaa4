"""The surface of a convex polyhedron given by planes: its corners and triangles."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel

PARALLEL = 1e-9  # below this determinant, three unit normals do not make a corner
TOUCH = 1e-6  # m, how far from a plane a corner still lies on it


def polyhedron(planes: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the surface of the convex polyhedron bounded by some planes.

    Every face is a loop over the same corners, so the surface is closed regardless of rounding.

    Args:
        planes: (F, 4) outward unit normals and offsets in m. A plane that touches the polyhedron only at a
            corner or an edge gives no triangle.

    Returns:
        Corners (V, 3) in m, and triangles (T, 3), wound as in ``Mesh``. Both are empty if the planes enclose
        nothing.
    """
    faces = len(planes)
    corners = np.empty((faces * (faces - 1) * (faces - 2) // 6, 3))
    corners = corners[: _find_corners(planes, corners)]
    triangles = np.empty((faces * len(corners), 3), np.int64)
    scratch = np.empty(len(corners), np.int64), np.empty(len(corners))
    return corners, triangles[: _find_triangles(planes, corners, *scratch, triangles)]


@kernel
def _find_corners(planes: NDArray[np.float64], corners: NDArray[np.float64]) -> int:
    """Write each corner once (where three planes meet and no other cuts it off); return how many."""
    faces = planes.shape[0]
    count = 0
    for a in range(faces):
        for b in range(a + 1, faces):
            for c in range(b + 1, faces):
                found, x, y, z = _meeting_point(planes, a, b, c)
                if found and _inside(planes, x, y, z) and not _known(corners, count, x, y, z):
                    corners[count, 0], corners[count, 1], corners[count, 2] = x, y, z
                    count += 1
    return count


@kernel
def _meeting_point(planes: NDArray[np.float64], a: int, b: int, c: int) -> tuple[bool, float, float, float]:
    """Solve three plane equations by Cramer's rule; the first value is False without a single solution."""
    ax, ay, az, a_offset = planes[a, 0], planes[a, 1], planes[a, 2], planes[a, 3]
    bx, by, bz, b_offset = planes[b, 0], planes[b, 1], planes[b, 2], planes[b, 3]
    cx, cy, cz, c_offset = planes[c, 0], planes[c, 1], planes[c, 2], planes[c, 3]
    bc_x, bc_y, bc_z = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    determinant = ax * bc_x + ay * bc_y + az * bc_z
    if abs(determinant) < PARALLEL:
        return False, 0.0, 0.0, 0.0
    ca_x, ca_y, ca_z = cy * az - cz * ay, cz * ax - cx * az, cx * ay - cy * ax
    ab_x, ab_y, ab_z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    x = (a_offset * bc_x + b_offset * ca_x + c_offset * ab_x) / determinant
    y = (a_offset * bc_y + b_offset * ca_y + c_offset * ab_y) / determinant
    z = (a_offset * bc_z + b_offset * ca_z + c_offset * ab_z) / determinant
    return True, x, y, z


@kernel
def _inside(planes: NDArray[np.float64], x: float, y: float, z: float) -> bool:
    for face in range(planes.shape[0]):
        if planes[face, 0] * x + planes[face, 1] * y + planes[face, 2] * z > planes[face, 3] + TOUCH:
            return False
    return True


@kernel
def _known(corners: NDArray[np.float64], count: int, x: float, y: float, z: float) -> bool:
    for corner in range(count):
        apart = max(abs(corners[corner, 0] - x), abs(corners[corner, 1] - y), abs(corners[corner, 2] - z))
        if apart < 2.0 * TOUCH:
            return True
    return False


@kernel
def _find_triangles(
    planes: NDArray[np.float64],
    corners: NDArray[np.float64],
    loop: NDArray[np.int64],
    turn: NDArray[np.float64],
    triangles: NDArray[np.int64],
) -> int:
    """Write a fan of triangles for every face and return how many; for loop and turn see ``_face_loop``."""
    count = 0
    for face in range(planes.shape[0]):
        size = _face_loop(planes, face, corners, loop, turn)
        for index in range(1, size - 1):
            triangles[count, 0] = loop[0]
            triangles[count, 1] = loop[index]
            triangles[count, 2] = loop[index + 1]
            count += 1
    return count


@kernel
def _face_loop(
    planes: NDArray[np.float64],
    face: int,
    corners: NDArray[np.float64],
    loop: NDArray[np.int64],
    turn: NDArray[np.float64],
) -> int:
    """Write the corners on a face in order about its normal; return how many.

    Args:
        planes: (F, 4) outward unit normals and offsets in m.
        face: The plane of the face.
        corners: (V, 3) m.
        loop: (V,) written: the corners on the face; the rest is left unchanged.
        turn: (V,) scratch buffer for their angles.
    """
    nx, ny, nz, offset = planes[face, 0], planes[face, 1], planes[face, 2], planes[face, 3]
    size = 0
    x, y, z = 0.0, 0.0, 0.0
    for corner in range(corners.shape[0]):
        distance = nx * corners[corner, 0] + ny * corners[corner, 1] + nz * corners[corner, 2] - offset
        if abs(distance) <= 2.0 * TOUCH:
            loop[size] = corner
            size += 1
            x, y, z = x + corners[corner, 0], y + corners[corner, 1], z + corners[corner, 2]
    if size < 3:
        return 0
    x, y, z = x / size, y / size, z / size
    right_x, right_y, right_z = corners[loop[0], 0] - x, corners[loop[0], 1] - y, corners[loop[0], 2] - z
    up_x, up_y, up_z = ny * right_z - nz * right_y, nz * right_x - nx * right_z, nx * right_y - ny * right_x
    for index in range(size):
        corner = loop[index]
        out_x, out_y, out_z = corners[corner, 0] - x, corners[corner, 1] - y, corners[corner, 2] - z
        along = out_x * right_x + out_y * right_y + out_z * right_z
        across = out_x * up_x + out_y * up_y + out_z * up_z
        _insert(index, corner, _turn(along, across), loop, turn)
    return size


@kernel
def _turn(along: float, across: float) -> float:
    """Return a number in [0, 4) that grows with the angle of a vector."""
    share = across / max(abs(along) + abs(across), 1e-300)
    if along < 0.0:
        return 2.0 - share
    return share if across >= 0.0 else 4.0 + share


@kernel
def _insert(
    count: int, corner: int, angle: float, loop: NDArray[np.int64], turn: NDArray[np.float64]
) -> None:
    """Insert one more corner among the first ``count``, which are in order."""
    place = count
    while place > 0 and turn[place - 1] > angle:
        loop[place], turn[place] = loop[place - 1], turn[place - 1]
        place -= 1
    loop[place], turn[place] = corner, angle
