"""Importing a triangle mesh of convex parts as ground and solids."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.base import KINDS, LARGEST, MOST_SOLIDS, OVERHANG, SMALLEST, Base, BaseError
from wildscav_engine.maps.importing.ground import ground_from
from wildscav_engine.maps.importing.imported import Imported, finish
from wildscav_engine.maps.importing.parts import Part, read_parts
from wildscav_engine.maps.importing.pieces import solid_of, split

# The kind of a part by a word in its name; the last such word counts, as in "ground floor".
KIND_OF = {kind.name.lower(): kind for kind in (*KINDS, Kind.TERRAIN, Kind.WATER)} | {"ground": Kind.TERRAIN}
PLURALS = {f"{word}s": kind for word, kind in KIND_OF.items()} | {"bushes": Kind.BUSH}
NAMED_AT_MOST = 3  # parts in a note
COVERED = 0.999  # share of the grid above which the ground counts as complete
NOISE = 1e-3  # m by which a mesh may be larger than its map


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
        if len(pieces) > MOST_SOLIDS:
            raise BaseError(f"it has more than {MOST_SOLIDS} parts")
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
