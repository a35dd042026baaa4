"""Convex solids with their corners, as tracing needs them: those of a world and the moving ones."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import Solid, World
from wildscav_engine.rendering.tracing.scene_arrays import Shapes

NO_OWNER = -1
UPRIGHT = 1e-6  # greatest upward part of the unit normal of an upright face


class Solids(NamedTuple):
    """S convex solids with F faces and C corners in all."""

    kind: NDArray[np.int8]  # (S,) a Kind
    owner: NDArray[np.int32]  # (S,) the viewer whose own body this is, which does not see it, or NO_OWNER
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
    """Return solids as arrays; without ``owners`` they have none."""
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


def shapes_of(solids: Solids, order: NDArray[np.int64], names: NDArray[np.integer]) -> Shapes:
    """Return some solids, in an order and with names, in the form for kernels."""
    corners, corner_start = _picked(solids.corners, solids.corner_start, order)
    faces, face_start = _picked(solids.faces, solids.face_start, order)
    picked = solids._replace(faces=faces, face_start=face_start, corners=corners, corner_start=corner_start)
    return _as_shapes(picked, np.asarray(names, np.int64), solids.face_start[order])


def all_shapes_of(solids: Solids) -> Shapes:
    """Return all solids in the form for kernels, named by their owners."""
    return _as_shapes(solids, solids.owner.astype(np.int64), solids.face_start[:-1])


def _as_shapes(solids: Solids, names: NDArray[np.int64], face_names: NDArray[np.int64]) -> Shapes:
    obbs = np.empty((len(names), 9))
    write_obbs(solids.faces, solids.face_start, solids.corners, solids.corner_start, obbs)
    return Shapes(obbs, solids.face_start, solids.faces, names, face_names)


@kernel
def write_obbs(
    faces: NDArray[np.float64],
    face_start: NDArray[np.int64],
    corners: NDArray[np.float64],
    corner_start: NDArray[np.int64],
    obbs: NDArray[np.float64],
) -> None:
    """Write a bounding box of each solid, rotated like its first upright face; see ``Shapes``."""
    for solid in range(obbs.shape[0]):
        sine, cosine = 0.0, 1.0  # of the box's yaw
        for face in range(face_start[solid], face_start[solid + 1]):
            if abs(faces[face, 1]) < UPRIGHT:
                length = np.sqrt(faces[face, 0] * faces[face, 0] + faces[face, 2] * faces[face, 2])
                sine, cosine = faces[face, 0] / length, faces[face, 2] / length
                break
        low, high = (np.inf, np.inf, np.inf), (-np.inf, -np.inf, -np.inf)
        for corner in range(corner_start[solid], corner_start[solid + 1]):
            x, y, z = corners[corner, 0], corners[corner, 1], corners[corner, 2]
            across, along = x * cosine - z * sine, x * sine + z * cosine
            low = (min(low[0], across), min(low[1], y), min(low[2], along))
            high = (max(high[0], across), max(high[1], y), max(high[2], along))
        across, along = 0.5 * (low[0] + high[0]), 0.5 * (low[2] + high[2])
        wide, tall, deep = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
        obbs[solid, 0] = across * cosine + along * sine
        obbs[solid, 1] = 0.5 * (low[1] + high[1])
        obbs[solid, 2] = along * cosine - across * sine
        obbs[solid, 3] = np.sqrt(wide * wide + tall * tall + deep * deep)
        obbs[solid, 4] = tall
        obbs[solid, 5], obbs[solid, 6] = wide * cosine, -wide * sine
        obbs[solid, 7], obbs[solid, 8] = deep * sine, deep * cosine


def _picked(
    values: NDArray[np.float64], start: NDArray[np.int64], order: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the values of the solids in an order, and where the values of each start."""
    counts = (start[1:] - start[:-1])[order]
    picked = _starts(counts)
    rows = np.arange(picked[-1]) + np.repeat(start[order] - picked[:-1], counts)
    return values[rows], picked


def _starts(counts: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(counts, dtype=np.int64)])
