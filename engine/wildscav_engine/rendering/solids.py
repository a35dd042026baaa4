"""Convex solids with their corners, as images need them: those of a world, and those that move in it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import Solid, World

NO_OWNER = -1


class Solids(NamedTuple):
    """S convex solids with F faces and C corners in all."""

    kind: NDArray[np.int8]  # (S,) a Kind
    owner: NDArray[np.int32]  # (S,) the viewer whose own body this is, and who does not see it, or NO_OWNER
    low: NDArray[np.float64]  # (S, 3) m, least corner of the box around a solid
    high: NDArray[np.float64]  # (S, 3) m, greatest corner
    face_start: NDArray[np.int64]  # (S + 1,) where each solid's faces start in faces
    faces: NDArray[np.float64]  # (F, 4) outward unit normal and its offset in m
    corner_start: NDArray[np.int64]  # (S + 1,) where each solid's corners start in corners
    corners: NDArray[np.float64]  # (C, 3) m


def solids_of_world(world: World) -> Solids:
    """Return all solids of a world."""
    ends = world.solid_start
    corners = [polyhedron(world.faces[ends[row] : ends[row + 1]])[0] for row in range(len(world.solid_kind))]
    owner = np.full(len(corners), NO_OWNER, np.int32)
    return Solids(
        world.solid_kind,
        owner,
        world.solid_low,
        world.solid_high,
        world.solid_start,
        world.faces,
        _starts([len(part) for part in corners]),
        np.concatenate([np.zeros((0, 3)), *corners]),
    )


def gather_solids(solids: Sequence[Solid], owners: Sequence[int] | None = None) -> Solids:
    """Return some solids as arrays; nobody owns them if no owners are given."""
    corners = [polyhedron(solid.planes)[0] for solid in solids]
    return Solids(
        np.array([solid.kind for solid in solids], np.int8),
        np.array([NO_OWNER] * len(solids) if owners is None else owners, np.int32),
        np.array([solid.low for solid in solids], np.float64).reshape(-1, 3),
        np.array([solid.high for solid in solids], np.float64).reshape(-1, 3),
        _starts([len(solid.planes) for solid in solids]),
        np.concatenate([np.zeros((0, 4)), *(solid.planes for solid in solids)]),
        _starts([len(part) for part in corners]),
        np.concatenate([np.zeros((0, 3)), *corners]),
    )


def _starts(counts: Sequence[int]) -> NDArray[np.int64]:
    return np.cumsum([0, *counts]).astype(np.int64)
