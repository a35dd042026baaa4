"""Importing a triangle mesh of convex parts as ground and solids."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import CELL, Kind, Solid
from wildscav_engine.maps.base import (
    KINDS,
    LARGEST,
    MAX_FACES,
    MAX_SOLIDS,
    OVERHANG,
    SMALLEST,
    Base,
    BaseError,
    Imported,
    finish,
)
from wildscav_engine.maps.importing.parts import Part, read_parts

# The kind of a part by a word in its name; the last such word counts, as in "ground floor".
KIND_OF = {kind.name.lower(): kind for kind in (*KINDS, Kind.TERRAIN, Kind.WATER)} | {"ground": Kind.TERRAIN}
PLURALS = {f"{word}s": kind for word, kind in KIND_OF.items()} | {"bushes": Kind.BUSH}
NAMED_AT_MOST = 3  # parts in a note
COVERED = 0.999  # share of the grid above which the ground counts as complete
NOISE = 1e-3  # m by which a mesh may be larger than its map
EDGE = 1e-6  # tolerance in barycentric coordinates for points outside a triangle
SAME_PLACE = 1e-5  # m, below which two vertices are one
FLAT = 1e-3  # m, below which a piece has no thickness
DENT = 0.01  # share of its hull that a convex piece may leave empty
SAME_NORMAL = 1e-6  # how far the cosine between two normals may be from 1; 0.08°
SAME_OFFSET = 1e-3  # m between the planes of two triangles of one face
ASIDE = 0.7  # cosine of 45.6°, the greatest angle between a direction and a face that blunts the solid there
MAX_OWN_FACES = MAX_FACES - 6  # in addition to those that blunt it
DIRECTIONS = np.concatenate([np.eye(3), -np.eye(3)])


def import_mesh(
    path: Path,
    *,
    size: int | None = None,
    water_level: float | None = None,
    name: str | None = None,
    centered: bool = True,
) -> Imported:
    """Make a base from a GLB or OBJ file.

    Every closed piece of it must be convex. The names of parts give their kinds: wall, floor, stair, roof,
    trunk, crown, rock, furniture or bush; parts without such a name are walls. A part called terrain or
    ground gives the ground, which is otherwise flat at height 0; one called water gives the level of the
    lakes.

    Args:
        path: The file: metres, y up.
        size: m, of each side of the map; None: the smallest that holds the mesh.
        water_level: m; None: that of the mesh, no water if it has none.
        name: The name of the base; None for the file's name.
        centered: Whether to move the mesh to the middle of the map.

    Returns:
        The base, and notes on what was left out.

    Raises:
        BaseError: The file is not such a mesh, or no map can be made on it.
    """
    try:
        parts = [(_kind_of(part.words), part) for part in read_parts(path)]
        grounds = [part for kind, part in parts if kind is Kind.TERRAIN]
        lakes = [part for kind, part in parts if kind is Kind.WATER]
        others = [(kind, part) for kind, part in parts if kind not in {Kind.TERRAIN, Kind.WATER}]
        shift, size = _frame(grounds or [part for _, part in parts], size, centered)
        notes: list[str] = []
        heights = _ground(grounds, shift, size, notes)
        solids = _solids(others, shift, size, notes)
        if water_level is None:
            water_level = max((float(part.vertices[:, 1].max()) for part in lakes), default=-np.inf)
        return finish(Base(heights, water_level, tuple(solids), size, name or path.stem), notes)
    except BaseError as error:
        raise BaseError(f"{path}: {error}") from None


def _kind_of(words: str) -> Kind:
    """Return the kind of a part with a name such as "Stone_Walls.003" or "groundFloor"."""
    for word in reversed(re.findall(r"[A-Z]?[a-z]+|[A-Z]+", words)):
        kind = (KIND_OF | PLURALS).get(word.lower())
        if kind is not None:
            return kind
    return Kind.WALL


def _frame(parts: Sequence[Part], size: int | None, centered: bool) -> tuple[NDArray[np.float64], int]:
    """Return the shift of the mesh, (3,) m, and the size of its map."""
    low = np.min([part.vertices.min(axis=0) for part in parts], axis=0)
    high = np.max([part.vertices.max(axis=0) for part in parts], axis=0)
    shift = -(low + high) / 2 * [1, 0, 1] if centered else np.zeros(3)
    reach = float(np.max(np.abs([low + shift, high + shift])[:, [0, 2]]))
    least = max(SMALLEST, 2 * int(np.ceil(reach - NOISE)))
    if least > LARGEST:
        raise BaseError(f"it needs a map of {least} m, {LARGEST} are allowed; its unit must be the metre")
    if size is not None and size < least:
        raise BaseError(f"size is {size}, but it needs a map of {least} m")
    return shift, least if size is None else size


def _ground(
    grounds: Sequence[Part], shift: NDArray[np.float64], size: int, notes: list[str]
) -> NDArray[np.float64] | None:
    if not grounds:
        return None
    vertices = np.concatenate([part.vertices for part in grounds]) + shift
    firsts = np.cumsum([0] + [len(part.vertices) for part in grounds])
    triangles = np.concatenate([part.triangles + first for part, first in zip(grounds, firsts, strict=False)])
    heights, covered = ground_from(vertices, triangles, size)
    if covered < COVERED:
        notes.append(
            f"the ground covers {100 * covered:.0f} % of the map; the rest is as high as what is next"
        )
    return heights


def _solids(
    parts: Sequence[tuple[Kind, Part]], shift: NDArray[np.float64], size: int, notes: list[str]
) -> list[Solid]:
    pieces = []
    for kind, part in parts:
        found = split(part.vertices + shift, part.triangles)
        several = len(found) > 1
        for number, piece in enumerate(found, start=1):
            pieces.append((kind, f"{part.name!r}" + (f" (piece {number})" if several else ""), piece))
        if len(pieces) > MAX_SOLIDS:
            raise BaseError(f"it has more than {MAX_SOLIDS} parts")
    solids, flat = [], []
    for kind, name, piece in pieces:
        solid = solid_of(kind, name, piece)
        if solid is None:
            flat.append(name)
        elif _is_outside(solid, size):
            raise BaseError(f"{name} lies outside the map of {size} m")
        else:
            solids.append(solid)
    if flat:
        more = f" and {len(flat) - NAMED_AT_MOST} more" if len(flat) > NAMED_AT_MOST else ""
        notes.append(f"left out, because flat: {', '.join(flat[:NAMED_AT_MOST])}{more}")
    return solids


def _is_outside(solid: Solid, size: int) -> bool:
    """Return whether a solid is outside the map or reaches too far beyond its border."""
    plan = np.array([solid.low, solid.high])[:, [0, 2]]
    return bool(np.abs(plan.mean(axis=0)).max() > size / 2 or np.abs(plan).max() > size / 2 + OVERHANG)


def ground_from(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64], size: int
) -> tuple[NDArray[np.float64], float]:
    """Return the heights of a surface on the grid of a map, and the share of the grid that it covers.

    Args:
        vertices: (V, 3) m, in the frame of the map.
        triangles: (T, 3) vertices; of several above each other, the highest counts.
        size: m, of each side of the map.

    Returns:
        (R + 1, C + 1) m; outside the surface, the height of the nearest point on it. And the share.

    Raises:
        BaseError: The surface lies over no point of the grid.
    """
    from scipy.ndimage import distance_transform_edt

    points = round(size / CELL) + 1
    heights = np.full((points, points), -np.inf)
    _drape(vertices, triangles, -size / 2, heights)
    bare = heights == -np.inf
    if bare.all():
        raise BaseError("its ground lies over no part of the map")
    rows, columns = distance_transform_edt(bare, return_distances=False, return_indices=True)
    return heights[rows, columns], float(1.0 - bare.mean())


@kernel
def _drape(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64], corner: float, heights: NDArray[np.float64]
) -> None:
    """Raise every point of a grid, (R, C) m from a corner on, to the highest triangle at its position."""
    rows, columns = heights.shape
    for number in range(triangles.shape[0]):
        a, b, c = triangles[number, 0], triangles[number, 1], triangles[number, 2]
        ax, ay, az = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        bx, bz = vertices[b, 0] - ax, vertices[b, 2] - az
        cx, cz = vertices[c, 0] - ax, vertices[c, 2] - az
        twice_area = bx * cz - bz * cx
        if twice_area == 0.0:
            continue  # upright: it covers no area
        first_row = max(0, int(np.ceil((az + min(0.0, bz, cz) - corner) / CELL - EDGE)))
        last_row = min(rows - 1, int(np.floor((az + max(0.0, bz, cz) - corner) / CELL + EDGE)))
        first_column = max(0, int(np.ceil((ax + min(0.0, bx, cx) - corner) / CELL - EDGE)))
        last_column = min(columns - 1, int(np.floor((ax + max(0.0, bx, cx) - corner) / CELL + EDGE)))
        for row in range(first_row, last_row + 1):
            z = corner + row * CELL - az
            for column in range(first_column, last_column + 1):
                x = corner + column * CELL - ax
                share_b = (x * cz - z * cx) / twice_area
                share_c = (bx * z - bz * x) / twice_area
                if share_b >= -EDGE and share_c >= -EDGE and share_b + share_c <= 1.0 + EDGE:
                    height = ay + share_b * (vertices[b, 1] - ay) + share_c * (vertices[c, 1] - ay)
                    heights[row, column] = max(heights[row, column], height)


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
        if len(planes) > MAX_OWN_FACES:
            raise BaseError(f"{name} has more than {MAX_OWN_FACES} faces: use a simpler shape, or split it")
    return np.array(planes)


def _blunt(planes: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the planes with additional ones that touch a solid at its sharp edges and tips.

    Collision pushes the planes out, so without these a body would be stopped metres away from a roof's sharp
    edge.
    """
    missing = [direction for direction in DIRECTIONS if (planes[:, :3] @ direction).max() < ASIDE]
    touching = [[*direction, (corners * direction).sum(axis=1).max()] for direction in missing]
    return np.concatenate([planes, np.array(touching).reshape(-1, 4)])
