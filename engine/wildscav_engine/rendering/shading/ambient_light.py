"""Light on surfaces from the sky, as far as roofs and nearby surfaces leave it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.hits import WATER_HIT, Hits
from wildscav_engine.rendering.shading.ambient_occlusion import REACH, Around, reach_of, unoccluded_share
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.columns import Columns
from wildscav_engine.rendering.shading.light import is_roofed, write_skylight
from wildscav_engine.rendering.shading.occlusion_along_rows import are_alike_far, write_shares, write_tilts
from wildscav_engine.rendering.shading.pixel_rays import View, Ways
from wildscav_engine.rendering.shading.pixel_rows import Normals, Places, RowOfPixels

# m, and m per m of distance, off the surface, where a ray to the light starts.
LIFT, LIFT_SHARE = np.float32(0.004), np.float32(2e-4)
FARTHEST = np.float32(2000.0)  # m, the greatest range of cameras
WIDE = 2.0  # pixels, within which nearby surfaces occlude, from where on four pixels share the result
SPAN, FEWEST = 32, 8  # pixels of a row that are looked at together, at most and at least
MARGIN = 1.2  # how much farther around others than the first of them may be looked at


@inlined_kernel
def write_ambient(
    upwards: Columns,
    world: World,
    view: View,
    hit: Hits,
    depths: NDArray[np.float32],
    row: int,
    pieces: NDArray[np.int32],
    count: int,
    around: Around,
    pixels: RowOfPixels,
) -> None:
    """Write the ambient light on the surfaces of a row.

    Args:
        depths: (H, W) m along the view axis.
    """
    _write_skylight(upwards, world, hit.solid[row], pieces, count, pixels)
    write_tilts(view, row, pixels.normal, pixels.tilt)
    distances = hit.distance[row]
    for first in range(0, view.width, SPAN):
        last = min(view.width, first + SPAN)
        are_alike = are_alike_far(distances[first:last])
        if are_alike and hit.solid[row, first] == NOTHING_HIT:
            continue
        low, high = _together(view, hit, row, first, last) if are_alike else (last, last)
        _write_each(view, hit, depths, row, first, low, around, pixels)
        if low < high:
            shares, distance = pixels.unoccluded[low:high], float(distances[low])
            write_shares(depths, view, row, low, distance, pixels.tilt, shares)
        _write_each(view, hit, depths, row, high, last, around, pixels)
    for column in range(view.width):
        pixels.ambient[column] *= pixels.unoccluded[column]


@inlined_kernel
def _together(view: View, hit: Hits, row: int, first: int, last: int) -> tuple[int, int]:
    """Return which of the columns from ``first`` to before ``last`` are looked at together, possibly none.

    All are about as far. The pixels around them must be in the image, and nothing takes light from water.
    """
    if hit.solid[row, first] == WATER_HIT:
        return last, last
    far = int(reach_of(view, float(hit.distance[row, first])) * MARGIN + 1.0)
    low, high = max(first, far), min(last, view.width - far)
    return (low, high) if high - low >= FEWEST else (last, last)


@inlined_kernel
def _write_skylight(
    upwards: Columns,
    world: World,
    solids: NDArray[np.int32],
    pieces: NDArray[np.int32],
    count: int,
    pixels: RowOfPixels,
) -> None:
    """Write the light from the sky on the surfaces of a row, as if nothing were near.

    Where both ends of a short piece of one surface are under a roof, or neither is, so is the rest.
    """
    write_skylight(pixels.normal, False, pixels.ambient)
    for piece in range(count):
        if solids[pieces[piece]] == NOTHING_HIT:
            continue
        for first in range(pieces[piece], pieces[piece + 1], SPAN):
            last = min(pieces[piece + 1], first + SPAN)
            begins_roofed = is_roofed(upwards, world, place_of(pixels.place, first))
            ends_roofed = is_roofed(upwards, world, place_of(pixels.place, last - 1))
            if begins_roofed & ends_roofed:
                _write_roofed(first, last, pixels)
            elif begins_roofed | ends_roofed:
                for column in range(first, last):
                    if is_roofed(upwards, world, place_of(pixels.place, column)):
                        _write_roofed(column, column + 1, pixels)


@inlined_kernel
def _write_roofed(first: int, last: int, pixels: RowOfPixels) -> None:
    """Write the ambient light from one column to before another, all under a roof."""
    normal = pixels.normal
    some = Normals(normal.east[first:last], normal.up[first:last], normal.north[first:last])
    write_skylight(some, True, pixels.ambient[first:last])


@disjoint_kernel
def write_places_off(
    view: View, ways: Ways, normal: Normals, distances: NDArray[np.float32], place: Places
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
def place_of(place: Places, column: int) -> Vector:
    """Return one of the places of a row."""
    return float(place.x[column]), float(place.y[column]), float(place.z[column])


@inlined_kernel
def _write_each(
    view: View,
    hit: Hits,
    depths: NDArray[np.float32],
    row: int,
    first: int,
    last: int,
    around: Around,
    pixels: RowOfPixels,
) -> None:
    """Write the shares of light that nearby surfaces leave of some columns one by one.

    They change little from pixel to pixel, so four pixels share one if they show the same surface.
    """
    shares = pixels.unoccluded
    for column in range(first, last):
        distance = float(hit.distance[row, column])
        is_wide = WIDE * distance * view.pixel <= REACH
        if hit.solid[row, column] in (NOTHING_HIT, WATER_HIT):
            shares[column] = 1.0
        elif is_wide and column & 1 and _is_same(hit, row, column, row, column - 1):
            shares[column] = shares[column - 1]
        elif is_wide and row & 1 and _is_same(hit, row, column, row - 1, column):
            shares[column] = pixels.unoccluded_above[column]
        else:
            shares[column] = unoccluded_share(depths, row, column, view, distance, pixels.tilt, around)


@inlined_kernel
def _is_same(hit: Hits, row: int, column: int, other_row: int, other_column: int) -> bool:
    """Return whether two pixels show the same face of a solid, or both the ground."""
    solid = hit.solid[row, column]
    is_alike = hit.face[row, column] == hit.face[other_row, other_column] or solid == TERRAIN_HIT
    return bool(solid == hit.solid[other_row, other_column] and is_alike)
