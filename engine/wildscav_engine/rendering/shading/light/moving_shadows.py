"""The shadows of what moves: agents and supply boxes.

The shadow of a solid is found where the line to the sun through a place crosses the level of the sea. There
the coordinates are across the sun's direction and along it, so that the shadows of tall things are narrow. A
coarse map says whose shadows may be where, so that most pixels ask no solid at all, and the others a few.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.light.columns import clip_ray
from wildscav_engine.rendering.shading.pixel_rows import Places
from wildscav_engine.rendering.shading.sky import SUN_DIRECTION
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.solids import Solids

REACH = 40.0  # m from the eye, up to which moving solids cast shadows
LEVEL = math.sqrt(SUN_DIRECTION[0] * SUN_DIRECTION[0] + SUN_DIRECTION[2] * SUN_DIRECTION[2])
EAST, NORTH = SUN_DIRECTION[0] / LEVEL, SUN_DIRECTION[2] / LEVEL  # level unit vector to the sun
LEAN = LEVEL / SUN_DIRECTION[1]  # m towards the sun per m upwards
SQUARES, SIDE = 128, 0.375  # of the map, along each side, and m of each; those at its edges extend
LARGE, MOST_SQUARES = SQUARES * SQUARES, 64  # where those are noted whose shadows reach into more squares
NOWHERE = LARGE + 1  # where nothing is ever noted
MARGIN = 0.01  # m, by which shadows are enlarged, because places on the map are rounded to float32
EAST_32, NORTH_32, LEAN_32, PER_SIDE = (np.float32(number) for number in (EAST, NORTH, LEAN, 1.0 / SIDE))
FIRST, LAST, HALF = (np.float32(number) for number in (0.0, SQUARES - 1.0, SQUARES / 2))


class Casters(NamedTuple):
    """The moving solids that cast shadows in one image."""

    solids: NDArray[np.int64]  # (S,) their indices
    spans: NDArray[np.float64]  # (S, 5) m, of each shadow: from and to across, from and to along; its top
    # (NOWHERE + 1,) the first note of each square of the map, of those with large shadows, and of nothing; 0
    # for none
    first: NDArray[np.int32]
    notes: NDArray[np.int32]  # (1 + MOST_SQUARES * S, 2) a caster, and the next note, 0 for none
    middle: NDArray[np.float64]  # (2,) m, coordinates of the middle of the map


def allocate_casters(count: int) -> Casters:
    """Return uninitialized arrays for at most so many casters."""
    first, notes = np.empty(NOWHERE + 1, np.int32), np.empty((1 + MOST_SQUARES * count, 2), np.int32)
    return Casters(np.empty(count, np.int64), np.empty((count, 5)), first, notes, np.empty(2))


@kernel
def find_casters(moving: Solids, eye: Vector, casters: Casters) -> None:
    """Find the moving solids that are near enough to an eye to cast shadows."""
    casters.middle[0], casters.middle[1] = _across_and_along(eye[0], eye[1], eye[2])
    casters.first[:] = 0
    count, note = 0, 1
    for solid in range(moving.kind.shape[0]):
        low = moving.low[solid]
        dx, dz = low[0] - eye[0], low[2] - eye[2]
        if dx * dx + dz * dz < REACH * REACH:
            casters.solids[count] = solid
            _write_span(moving, solid, casters.spans[count])
            note = _note_on_map(casters, count, note)
            count += 1


@inlined_kernel
def _across_and_along(x: float, y: float, z: float) -> tuple[float, float]:
    """Return where the line to the sun through a place crosses the level of the sea, m."""
    return EAST * z - NORTH * x, EAST * x + NORTH * z - LEAN * y


@inlined_kernel
def _write_span(moving: Solids, solid: int, span: NDArray[np.float64]) -> None:
    """Write the span of the shadow of a moving solid."""
    least_across, most_across, least_along, most_along = np.inf, -np.inf, np.inf, -np.inf
    for corner in range(moving.corner_start[solid], moving.corner_start[solid + 1]):
        place = moving.corners[nonnegative(corner)]
        across, along = _across_and_along(place[0], place[1], place[2])
        least_across, most_across = min(least_across, across), max(most_across, across)
        least_along, most_along = min(least_along, along), max(most_along, along)
    span[0], span[1] = least_across - MARGIN, most_across + MARGIN
    span[2], span[3], span[4] = least_along - MARGIN, most_along + MARGIN, moving.high[solid, 1]


@inlined_kernel
def _note_on_map(casters: Casters, caster: int, note: int) -> int:
    """Note a caster in the squares of the map that its shadow may reach into; return the next free note."""
    span, middle = casters.spans[caster], casters.middle
    first, last = _square_of(span[0], middle[0]), _square_of(span[1], middle[0])
    south, north = _square_of(span[2], middle[1]), _square_of(span[3], middle[1])
    if (last + 1 - first) * (north + 1 - south) > MOST_SQUARES:
        return _note_in(casters, LARGE, caster, note)
    for row in range(south, north + 1):
        for square in range(row * SQUARES + first, row * SQUARES + last + 1):
            note = _note_in(casters, square, caster, note)
    return note


@inlined_kernel
def _note_in(casters: Casters, square: int, caster: int, note: int) -> int:
    """Note a caster in one square of the map."""
    at = nonnegative(note)
    casters.notes[at, 0], casters.notes[at, 1] = caster, casters.first[nonnegative(square)]
    casters.first[nonnegative(square)] = note
    return note + 1


@inlined_kernel
def _square_of(coordinate: float, middle: float) -> int:
    return int(min(SQUARES - 1.0, max(0.0, (coordinate - middle) * (1.0 / SIDE) + SQUARES / 2)))


@disjoint_kernel
def write_squares(casters: Casters, places: Places, squares: NDArray[np.int32]) -> None:
    """Write which squares of the map the shadows of casters at some places belong to."""
    middle_across, middle_along = np.float32(casters.middle[0]), np.float32(casters.middle[1])
    for place in range(squares.shape[0]):
        x, y, z = places.x[place], places.y[place], places.z[place]
        across = (EAST_32 * z - NORTH_32 * x - middle_across) * PER_SIDE + HALF
        along = (EAST_32 * x + NORTH_32 * z - LEAN_32 * y - middle_along) * PER_SIDE + HALF
        row, column = np.int32(min(LAST, max(FIRST, along))), np.int32(min(LAST, max(FIRST, across)))
        squares[place] = row * np.int32(SQUARES) + column


@inlined_kernel
def is_shaded_by(moving: Solids, casters: Casters, square: int, place: Vector) -> bool:
    """Return whether a caster stands between a place and the sun, given the place's square of the map."""
    across, along = _across_and_along(place[0], place[1], place[2])
    note, large = int(casters.first[nonnegative(square)]), int(casters.first[LARGE])
    while note > 0 or large > 0:
        if note == 0:
            note, large = large, 0
        caster = nonnegative(casters.notes[nonnegative(note), 0])
        span = casters.spans[caster]
        is_near = (span[0] <= across <= span[1]) & (span[2] <= along <= span[3]) & (place[1] <= span[4])
        if is_near:
            solid = nonnegative(casters.solids[caster])
            first, last = moving.face_start[solid], moving.face_start[solid + 1]
            enter, leave = clip_ray(moving.faces, first, last, place, SUN_DIRECTION)
            if enter < leave:
                return True
        note = int(casters.notes[nonnegative(note), 1])
    return False
