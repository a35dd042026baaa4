"""What the ray of each pixel hits: how far away, which solid, and which of its faces."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.rendering.trace import TracedImage
from wildscav_engine.rendering.tracing.frustum import Camera, nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, HitBuffer, index_in_code, is_terrain_code
from wildscav_engine.rendering.tracing.scene_arrays import Shapes
from wildscav_engine.rendering.tracing.solid_intersection import write_entered_faces

WATER_HIT = -3
LOOKED_AT = 16  # rays that are looked at together


class Hits(NamedTuple):
    """What each ray of N images hit."""

    distance: NDArray[np.float32]  # (N, H, W) m along the ray, inf without a hit
    solid: NDArray[np.int32]  # (N, H, W) see below
    face: NDArray[np.int32]  # (N, H, W) see below

    # solid: the index of a solid of the world; or the number of these plus the index of a moving solid; or
    # TERRAIN_HIT, WATER_HIT or NOTHING_HIT.
    # face: an index into Solids.faces of the world or of the moving solids; for terrain 2 * cell for the
    # south-eastern triangle, 2 * cell + 1 for the other; for water the cell (row * columns + column); else 0.


def allocate_hits(count: int, height: int, width: int) -> Hits:
    """Return uninitialized arrays for the hits of ``count`` images."""
    shape = (count, height, width)
    return Hits(np.empty(shape, np.float32), np.empty(shape, np.int32), np.empty(shape, np.int32))


@inlined_kernel
def is_same_surface(solid: int, face: int, other_solid: int, other_face: int) -> bool:
    """Return whether two pixels show the same face of a solid, or both the ground."""
    return bool((solid == other_solid) & ((face == other_face) | (solid == TERRAIN_HIT)))


@kernel
def write_hits(traced: TracedImage, hit: Hits) -> None:
    """Write what each ray of an image hit, in the terms of ``Hits``, all (H, W)."""
    solids, others, camera, buffer = traced.solids, traced.moving, traced.camera, traced.buffer
    height, width = hit.distance.shape
    for row in range(height):
        line = Hits(hit.distance[row], hit.solid[row], hit.face[row])
        start = nonnegative(row * width)
        mets, first = buffer.met[start : start + width], 0
        _write_terrain(buffer.distance[start : start + width], mets, line)
        while first < width:
            met, last = mets[nonnegative(first)], first + 1
            if met > NOTHING:
                while last < width and mets[nonnegative(last)] == met:
                    last += 1
                _write_solid(solids, others, met, camera, buffer, start, first, last, line)
            elif first % LOOKED_AT == 0 and not _has_solid(mets[first : first + LOOKED_AT]):
                last = first + LOOKED_AT
            first = last


@disjoint_kernel
def _has_solid(mets: NDArray[np.int32]) -> bool:
    """Return whether any of some rays hit a solid, in a loop that vectorizes."""
    is_any = np.int32(0)
    for ray in range(mets.shape[0]):
        is_any |= np.int32(mets[ray] > NOTHING)
    return bool(is_any != 0)


@disjoint_kernel
def _write_terrain(distances: NDArray[np.float64], mets: NDArray[np.int32], line: Hits) -> None:
    """Write the distances of a row, and everything about rays that hit no solid."""
    distance, solid, face = line
    for column in range(distance.shape[0]):
        distance[column] = np.inf if mets[column] == NOTHING else distances[column]
    for column in range(distance.shape[0]):
        met = mets[column]
        ground = TERRAIN_HIT if is_terrain_code(met) else WATER_HIT
        solid[column] = ground if met < NOTHING else NOTHING_HIT
        face[column] = index_in_code(met) if met < NOTHING else 0


@inlined_kernel
def _write_solid(
    solids: Shapes,
    others: Shapes,
    met: int,
    camera: Camera,
    buffer: HitBuffer,
    start: int,
    first: int,
    last: int,
    line: Hits,
) -> None:
    """Write the solid that some successive rays of a row hit, and its faces; the row begins at ``start``."""
    statics, faces = solids.obbs.shape[0], line.face[first:last]
    if met < statics:
        line.solid[first:last] = solids.names[met]
        write_entered_faces(solids, met, camera, start + first, solids.face_names[met], buffer, faces)
    else:
        line.solid[first:last] = met
        moving = met - statics
        write_entered_faces(others, moving, camera, start + first, others.face_names[moving], buffer, faces)
