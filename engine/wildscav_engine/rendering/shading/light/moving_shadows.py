"""The shadows of what moves: agents and supply boxes.

The shadow of a solid is found where the line to the sun through a place crosses the level of the sea: at the
coordinates (x - LEAN_X · y, z - LEAN_Z · y). A coarse map of these coordinates says where any shadow may be,
so that most pixels ask no solid at all.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.light.columns import clip_ray, span_along
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.rendering.tracing.solids import Solids

REACH = 40.0  # m from the eye, up to which moving solids cast shadows
LEAN_X, LEAN_Z = SUN_DIRECTION[0] / SUN_DIRECTION[1], SUN_DIRECTION[2] / SUN_DIRECTION[1]
SQUARES, SIDE = 128, 0.75  # of the map, along each side, and m of each; those at its edges extend


class Casters(NamedTuple):
    """The moving solids that cast shadows in one image."""

    solids: NDArray[np.int64]  # (S,) their indices, of which the first ``count`` are set
    spans: NDArray[np.float64]  # (S, 5) m, of each: west, east, south, north of its shadow, and its top
    map: NDArray[np.uint8]  # (SQUARES, SQUARES) 1 where there may be a shadow
    middle: NDArray[np.float64]  # (2,) m, coordinates of the middle of the map


def allocate_casters(count: int) -> Casters:
    """Return uninitialized arrays for at most so many casters."""
    return Casters(
        np.empty(count, np.int64), np.empty((count, 5)), np.empty((SQUARES, SQUARES), np.uint8), np.empty(2)
    )


@kernel
def find_casters(moving: Solids, eye: Vector, casters: Casters) -> int:
    """Find the moving solids that are near enough to an eye to cast shadows; return how many."""
    casters.middle[0], casters.middle[1] = eye[0] - LEAN_X * eye[1], eye[2] - LEAN_Z * eye[1]
    casters.map[:] = 0
    count = 0
    for solid in range(moving.kind.shape[0]):
        low, high = moving.low[solid], moving.high[solid]
        dx, dz = low[0] - eye[0], low[2] - eye[2]
        if dx * dx + dz * dz >= REACH * REACH:
            continue
        casters.solids[count] = solid
        span = casters.spans[count]
        span[0], span[1] = span_along(LEAN_X, low[0], high[0], low[1], high[1])
        span[2], span[3] = span_along(LEAN_Z, low[2], high[2], low[1], high[1])
        span[4] = high[1]
        for row in range(_square_of(span[2], casters.middle[1]), _square_of(span[3], casters.middle[1]) + 1):
            west, east = _square_of(span[0], casters.middle[0]), _square_of(span[1], casters.middle[0])
            casters.map[row, west : east + 1] = 1
        count += 1
    return count


@inlined_kernel
def _square_of(coordinate: float, middle: float) -> int:
    return int(min(SQUARES - 1.0, max(0.0, (coordinate - middle) * (1.0 / SIDE) + SQUARES / 2)))


@inlined_kernel
def is_shaded_by(moving: Solids, casters: Casters, count: int, place: Vector) -> bool:
    """Return whether one of the first ``count`` casters stands between a place and the sun."""
    if count == 0:
        return False
    x, z = place[0] - LEAN_X * place[1], place[2] - LEAN_Z * place[1]
    if casters.map[_square_of(z, casters.middle[1]), _square_of(x, casters.middle[0])] == 0:
        return False
    for item in range(count):
        span = casters.spans[item]
        is_near = (span[0] <= x <= span[1]) & (span[2] <= z <= span[3]) & (place[1] <= span[4])
        if is_near:
            solid = casters.solids[item]
            first, last = moving.face_start[solid], moving.face_start[solid + 1]
            enter, leave = clip_ray(moving.faces, first, last, place, SUN_DIRECTION)
            if enter < leave:
                return True
    return False
