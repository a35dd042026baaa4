"""Light on surfaces from the sky, as far as roofs and nearby surfaces leave it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.hits import WATER_HIT, is_same_surface
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.light.ambient_occlusion import (
    ALMOST,
    REACH,
    Around,
    are_alike_far,
    reach_of,
    unoccluded_share,
    write_shares,
    write_tilts,
)
from wildscav_engine.rendering.shading.light.columns import BLOCKED, ShadowColumns, is_blocked
from wildscav_engine.rendering.shading.pixel_rows import (
    Places,
    RowOfPixels,
    TracedRow,
    Vectors,
    View,
    place_at,
    vectors_in,
)
from wildscav_engine.rendering.tracing.frustum import nonnegative

# m, and m per m of distance, off the surface, where a ray to the light starts.
LIFT, LIFT_SHARE = np.float32(0.004), np.float32(2e-4)
FARTHEST = np.float32(2000.0)  # m, the greatest range of cameras
WIDE = 2.0  # pixels, within which nearby surfaces occlude, from where on four pixels share the result
SPAN, FEWEST = 32, 8  # pixels of a row that are looked at together, at most and at least
# Ambient light under the open sky and under a roof: its level, and how it grows with a normal's upward part.
OPEN, ROOFED = (0.90, 0.30), (0.94, 0.06)
SIDE_LIGHT = (-0.10, -0.04)  # additional ambient light on surfaces that face east, and north
MARGIN = 1.2  # how much farther around others than the first of them may be looked at


@inlined_kernel
def write_ambient(
    upwards: ShadowColumns, world: World, row: TracedRow, depths: NDArray[np.float32], around: Around
) -> None:
    """Write the ambient light on the surfaces of a row, given (H, W) m the depths along the view axis."""
    view, pixels = row.camera, row.pixels
    solids, distances = row.line.solid, row.line.distance
    _write_skylight(upwards, world, row)
    write_tilts(view, row.number, pixels.normal, pixels.tilt)
    for first in range(0, view.width, SPAN):
        last = min(view.width, first + SPAN)
        are_alike = are_alike_far(distances[first:last])
        if are_alike and solids[first] == NOTHING_HIT:
            continue
        low, high = _together(row, first, last) if are_alike else (last, last)
        _write_each(row, depths, first, low, around)
        if low < high:
            shares, distance = pixels.unoccluded[low:high], float(distances[low])
            write_shares(depths, view, row.number, low, distance, pixels.tilt, shares)
        _write_each(row, depths, high, last, around)
    for column in range(view.width):
        pixels.ambient[column] *= pixels.unoccluded[column]


@inlined_kernel
def _together(row: TracedRow, first: int, last: int) -> tuple[int, int]:
    """Return which of the columns from ``first`` to before ``last`` are looked at together, possibly none.

    All are about as far. The pixels around them must be in the image, and nothing takes light from water.
    """
    if row.line.solid[first] == WATER_HIT:
        return last, last
    far = int(reach_of(row.camera, float(row.line.distance[first])) * MARGIN + 1.0)
    low, high = max(first, far), min(last, row.camera.width - far)
    return (low, high) if high - low >= FEWEST else (last, last)


@inlined_kernel
def _write_skylight(upwards: ShadowColumns, world: World, row: TracedRow) -> None:
    """Write the light from the sky on the surfaces of a row, as if nothing were near.

    Where both ends of a short piece of one surface are under a roof, or neither is, so is the rest.
    """
    pixels, pieces = row.pixels, row.pieces
    write_skylight(pixels.normal, False, pixels.ambient)
    for piece in range(row.piece_count):
        if row.line.solid[pieces[piece]] == NOTHING_HIT:
            continue
        for first in range(pieces[piece], pieces[piece + 1], SPAN):
            last = min(pieces[piece + 1], first + SPAN)
            begins_roofed = is_roofed(upwards, world, place_at(pixels.place, first))
            ends_roofed = is_roofed(upwards, world, place_at(pixels.place, last - 1))
            if begins_roofed & ends_roofed:
                _write_roofed(first, last, pixels)
            elif begins_roofed | ends_roofed:
                for column in range(first, last):
                    if is_roofed(upwards, world, place_at(pixels.place, column)):
                        _write_roofed(column, column + 1, pixels)


@inlined_kernel
def is_roofed(upwards: ShadowColumns, world: World, place: Vector) -> bool:
    """Return whether there is a floor or a roof above a place, given the columns of these."""
    return is_blocked(upwards, world, place) == BLOCKED


@disjoint_kernel
def write_skylight(normal: Vectors, roofed: bool, ambient: NDArray[np.float32]) -> None:
    """Write the ambient light on surfaces.

    Under the open sky most of it comes from above, in a house from all walls. It is slightly brighter on one
    side, so that the edge between two walls is visible.
    """
    level, rise = ROOFED if roofed else OPEN
    for column in range(ambient.shape[0]):
        east, up, north = float(normal.east[column]), float(normal.up[column]), float(normal.north[column])
        ambient[column] = level + rise * up + (SIDE_LIGHT[0] * east + SIDE_LIGHT[1] * north)


@inlined_kernel
def _write_roofed(first: int, last: int, pixels: RowOfPixels) -> None:
    """Write the ambient light from one column to before another, all under a roof."""
    write_skylight(vectors_in(pixels.normal, first, last), True, pixels.ambient[first:last])


@disjoint_kernel
def write_places_off(
    view: View, ways: Vectors, normal: Vectors, distances: NDArray[np.float32], place: Places
) -> None:
    """Write the places slightly off the surfaces of a row, where rays to the light start."""
    x, y, z = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    for column in range(distances.shape[0]):
        distance = min(FARTHEST, distances[column])
        lift = LIFT + LIFT_SHARE * distance
        place.x[column] = x + (ways.east[column] * distance + normal.east[column] * lift)
        place.y[column] = y + (ways.up[column] * distance + normal.up[column] * lift)
        place.z[column] = z + (ways.north[column] * distance + normal.north[column] * lift)


@inlined_kernel
def _write_each(row: TracedRow, depths: NDArray[np.float32], first: int, last: int, around: Around) -> None:
    """Write the shares of light that nearby surfaces leave of some columns one by one.

    They change little from pixel to pixel, so four pixels share one if they show the same surface.
    """
    number, shares, above = row.number, row.pixels.unoccluded, row.pixels.unoccluded_above
    distances, solids, faces = row.line
    over, even = max(0, number - 1), first + (first & 1)
    solids_over, faces_over = row.hit.solid[over], row.hit.face[over]
    is_as_above = number & 1 and last - even >= FEWEST and _is_as_above(row, even, last)
    for at in range(first, even if is_as_above else last):
        column, left = nonnegative(at), nonnegative(at - 1)
        solid, face, distance = solids[column], faces[column], float(distances[column])
        is_wide = WIDE * distance * row.camera.pixel <= REACH
        if solid in (NOTHING_HIT, WATER_HIT):
            shares[column] = 1.0
        elif is_wide and column & 1 and is_same_surface(solid, face, solids[left], faces[left]):
            shares[column] = shares[left]
        elif is_wide and number & 1 and is_same_surface(solid, face, solids_over[column], faces_over[column]):
            shares[column] = above[column]
        else:
            tilt = row.pixels.tilt
            shares[column] = unoccluded_share(depths, number, column, row.camera, distance, tilt, around)
    if is_as_above:
        for left in range(even, last, 2):
            shares[nonnegative(left)] = above[nonnegative(left)]
        for right in range(even + 1, last, 2):
            shares[nonnegative(right)] = above[nonnegative(right - 1)]


@inlined_kernel
def _is_as_above(row: TracedRow, first: int, last: int) -> bool:
    """Return whether all pixels from one column on take the shares of the row above, as most of them do."""
    line, over = row.line, max(0, row.number - 1)
    if line.solid[nonnegative(first)] in (NOTHING_HIT, WATER_HIT):
        return False
    return _are_one_surface(
        line.solid[first:last],
        line.face[first:last],
        row.hit.solid[over][first:last],
        row.hit.face[over][first:last],
        line.distance[first:last],
        np.float32(ALMOST * REACH / (WIDE * row.camera.pixel)),
    )


@disjoint_kernel
def _are_one_surface(
    solids: NDArray[np.int32],
    faces: NDArray[np.int32],
    solids_over: NDArray[np.int32],
    faces_over: NDArray[np.int32],
    distances: NDArray[np.float32],
    far: np.float32,
) -> bool:
    """Return whether pixels and those above show one surface, not so far away, in a loop that vectorizes."""
    is_other = np.int32(0)
    for column in range(solids.shape[0]):
        is_other |= np.int32(solids[column] != solids[0]) | np.int32(solids_over[column] != solids[0])
        is_other_face = np.int32(faces[column] != faces[0]) | np.int32(faces_over[column] != faces[0])
        is_other |= is_other_face & np.int32(solids[0] != TERRAIN_HIT)
        is_other |= np.int32(distances[column] > far)
    return bool(is_other == 0)
