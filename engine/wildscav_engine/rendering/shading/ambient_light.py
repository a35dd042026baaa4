"""Light on surfaces from the sky, as far as roofs and nearby surfaces leave it."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import World
from wildscav_engine.rendering.shading.ambient_occlusion import REACH, reach_of, unoccluded_share
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.columns import Columns
from wildscav_engine.rendering.shading.light import is_roofed, skylight
from wildscav_engine.rendering.shading.occlusion_along_rows import are_alike_far, write_shares, write_tilts
from wildscav_engine.rendering.shading.pixel_rays import View, point_along, way_of
from wildscav_engine.rendering.shading.pixel_rows import RowOfPixels
from wildscav_engine.rendering.trace import WATER_HIT, Hits

LIFT, LIFT_SHARE = 0.004, 2e-4  # m, and m per m of distance, off the surface, where a ray to the light starts
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
    pixels: RowOfPixels,
) -> None:
    """Write the ambient light on the surfaces of a row, given what the rays of an image hit, all (H, W)."""
    _write_skylight(upwards, world, view, hit, row, pixels)
    write_tilts(view, row, pixels.normal, pixels.tilt)
    distances = hit.distance[row]
    for first in range(0, view.width, SPAN):
        last = min(view.width, first + SPAN)
        if hit.solid[row, first] == NOTHING_HIT and end_of_surface(hit, row, first, last) == last:
            continue
        low, high = _together(view, hit, row, first, last)
        _write_each(view, hit, depths, row, first, low, pixels)
        if low < high:
            shares, distance = pixels.unoccluded[low:high], float(distances[low])
            write_shares(depths, view, row, low, distance, pixels.tilt, shares)
        _write_each(view, hit, depths, row, high, last, pixels)
    for column in range(view.width):
        pixels.ambient[column] *= pixels.unoccluded[column]


@inlined_kernel
def _together(view: View, hit: Hits, row: int, first: int, last: int) -> tuple[int, int]:
    """Return which of the columns from ``first`` to before ``last`` are looked at together, possibly none.

    All must be about as far, and the pixels around them in the image. Nothing takes light from water.
    """
    if hit.solid[row, first] == WATER_HIT or not are_alike_far(hit.distance[row][first:last]):
        return last, last
    far = int(reach_of(view, float(hit.distance[row, first])) * MARGIN + 1.0)
    low, high = max(first, far), min(last, view.width - far)
    return (low, high) if high - low >= FEWEST else (last, last)


@inlined_kernel
def _write_skylight(
    upwards: Columns, world: World, view: View, hit: Hits, row: int, pixels: RowOfPixels
) -> None:
    """Write the light from the sky on the surfaces of a row, as if nothing were near.

    Where both ends of a short piece of one surface are under a roof, or neither is, so is the rest.
    """
    first = 0
    while first < view.width:
        last = end_of_surface(hit, row, first, min(view.width, first + SPAN))
        if hit.solid[row, first] != NOTHING_HIT:
            roofed = _is_under_roof(upwards, world, view, hit, row, first, pixels)
            if roofed == _is_under_roof(upwards, world, view, hit, row, last - 1, pixels):
                for column in range(first, last):
                    pixels.ambient[column] = skylight(_normal(pixels, column), roofed)
            else:
                for column in range(first, last):
                    roofed = _is_under_roof(upwards, world, view, hit, row, column, pixels)
                    pixels.ambient[column] = skylight(_normal(pixels, column), roofed)
        first = last


@inlined_kernel
def end_of_surface(hit: Hits, row: int, first: int, limit: int) -> int:
    """Return the first column after ``first`` that does not show the same surface, at most ``limit``."""
    last = first + 1
    while last < limit and _is_same(hit, row, last, row, first):
        last += 1
    return last


@inlined_kernel
def _normal(pixels: RowOfPixels, column: int) -> Vector:
    normal = pixels.normal
    return float(normal.east[column]), float(normal.up[column]), float(normal.north[column])


@inlined_kernel
def off_surface(view: View, distance: float, column: int, pixels: RowOfPixels) -> Vector:
    """Return the place slightly off the surface that a pixel shows, where a ray to the light starts."""
    place = point_along(view.eye, way_of(pixels.ways, column), distance)
    return point_along(place, _normal(pixels, column), LIFT + LIFT_SHARE * distance)


@inlined_kernel
def _is_under_roof(
    upwards: Columns, world: World, view: View, hit: Hits, row: int, column: int, pixels: RowOfPixels
) -> bool:
    """Return whether there is a floor or a roof above the place that a pixel shows."""
    return is_roofed(upwards, world, off_surface(view, float(hit.distance[row, column]), column, pixels))


@inlined_kernel
def _write_each(
    view: View,
    hit: Hits,
    depths: NDArray[np.float32],
    row: int,
    first: int,
    last: int,
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
            normal = _normal(pixels, column)
            shares[column] = unoccluded_share(depths, row, column, view, distance, normal)


@inlined_kernel
def _is_same(hit: Hits, row: int, column: int, other_row: int, other_column: int) -> bool:
    """Return whether two pixels show the same face of a solid, or both the ground."""
    solid = hit.solid[row, column]
    is_alike = hit.face[row, column] == hit.face[other_row, other_column] or solid == TERRAIN_HIT
    return bool(solid == hit.solid[other_row, other_column] and is_alike)
