"""Splitting a part of a mesh into closed pieces, and converting each to a convex solid."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.base import MOST_FACES, BaseError

SAME_PLACE = 1e-5  # m, below which two vertices are one
FLAT = 1e-3  # m, below which a piece has no thickness
DENT = 0.01  # share of its hull that a convex piece may leave empty
SAME_NORMAL = 1e-6  # how far the cosine between two normals may be from 1; 0.08°
SAME_OFFSET = 1e-3  # m between the planes of two triangles of one face
ASIDE = 0.7  # cosine of 45.6°, the greatest angle between a direction and a face that blunts the solid there
MOST_OWN_FACES = MOST_FACES - 6  # in addition to those that blunt it
DIRECTIONS = np.concatenate([np.eye(3), -np.eye(3)])


class Piece(NamedTuple):
    """Connected triangles: V vertices."""

    vertices: NDArray[np.float64]  # (V, 3) m
    closed: bool  # every edge has two triangles that run it in opposite ways
    volume: float  # m³, where it is closed


def split(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> list[Piece]:
    """Return the pieces of a part.

    Vertices are shared only as in the file, so that two touching boxes stay separate. Only if this leaves
    holes, vertices at the same place are merged, because many programs give every face its own vertices.
    """
    pieces = list(_pieces(vertices, triangles))
    if all(piece.closed for piece in pieces):
        return pieces
    places = np.round(vertices / SAME_PLACE).astype(np.int64)
    _, first, joined = np.unique(places, axis=0, return_index=True, return_inverse=True)
    triangles = joined.reshape(-1)[triangles]
    a, b, c = triangles.T
    return list(_pieces(vertices[first], triangles[(a != b) & (b != c) & (c != a)]))


def _pieces(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> Iterator[Piece]:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(vertices)
    start, end = triangles[:, [0, 1, 2]].ravel(), triangles[:, [1, 2, 0]].ravel()
    graph = coo_array((np.ones(len(start), np.int8), (start, end)), (count, count))
    number, label = connected_components(graph, directed=False)
    of_triangle = label[triangles[:, 0]]
    used = np.zeros(count, np.bool_)
    used[triangles] = True
    _, edge, uses = np.unique(start * count + end, return_inverse=True, return_counts=True)
    back = np.isin(start * count + end, end * count + start)
    open_edge = (uses[edge] != 1) | ~back
    holes = np.bincount(of_triangle, open_edge.reshape(-1, 3).any(axis=1), number)
    a, b, c = (vertices[triangles[:, corner]] - vertices.mean(axis=0) for corner in range(3))
    volume = np.bincount(of_triangle, np.sum(a * np.cross(b, c), axis=1) / 6, number)
    order = np.argsort(label, kind="stable")
    for piece in np.split(order, np.cumsum(np.bincount(label, minlength=number))[:-1]):
        which = label[piece[0]]
        if used[piece[0]]:
            yield Piece(vertices[piece], not holes[which], abs(float(volume[which])))


def solid_of(kind: Kind, name: str, piece: Piece) -> Solid | None:
    """Return a piece as a solid, None if it is flat.

    Raises:
        BaseError: It is open, not convex, or has too many faces.
    """
    from scipy.spatial import ConvexHull, QhullError

    middle = piece.vertices.mean(axis=0)
    local = piece.vertices - middle
    try:
        hull = ConvexHull(local)
    except QhullError:
        return None
    corners = local[hull.vertices]
    planes = _merge(name, hull.equations, corners)
    thickness = planes[:, 3] + (-(corners @ planes[:, :3].T)).max(axis=0)
    if thickness.min() < FLAT:
        return None
    if not piece.closed:
        raise BaseError(
            f"{name} has an open surface, or faces that look inwards: close it and turn its faces outwards"
        )
    if abs(hull.volume - piece.volume) > DENT * hull.volume:
        raise BaseError(
            f"{name} is not convex: it fills {100 * piece.volume / hull.volume:.0f} % of its hull; split it "
            "into convex parts, each an object, a group or a closed piece that shares no vertex with others"
        )
    planes = _blunt(planes, corners)
    planes[:, 3] += planes[:, 0] * middle[0] + planes[:, 1] * middle[1] + planes[:, 2] * middle[2]
    return Solid(kind, planes, corners.min(axis=0) + middle, corners.max(axis=0) + middle)


def _merge(name: str, equations: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the planes of a hull, (F, 4): one per face, with every corner behind it."""
    planes: list[NDArray[np.float64]] = []
    for equation in equations:
        normal = equation[:3] / np.sqrt(np.sum(equation[:3] * equation[:3]))
        offset = (corners * normal).sum(axis=1).max()
        if not any(
            known[:3] @ normal > 1.0 - SAME_NORMAL and abs(known[3] - offset) < SAME_OFFSET
            for known in planes
        ):
            planes.append(np.array([*normal, offset]))
        if len(planes) > MOST_OWN_FACES:
            raise BaseError(f"{name} has more than {MOST_OWN_FACES} faces: use a simpler shape, or split it")
    return np.array(planes)


def _blunt(planes: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the planes with additional ones that touch a solid at its sharp edges and tips.

    Collision pushes the planes out, so without these a body would be stopped metres away from a roof's sharp
    edge.
    """
    missing = [direction for direction in DIRECTIONS if (planes[:, :3] @ direction).max() < ASIDE]
    touching = [[*direction, (corners * direction).sum(axis=1).max()] for direction in missing]
    return np.concatenate([planes, np.array(touching).reshape(-1, 4)])
