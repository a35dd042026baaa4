"""Screen-space ambient occlusion: less light in corners, where a wall meets a floor or a foot the ground.

It uses what nearby pixels hit, so it casts no rays. After Mittring, "Finding Next Gen: CryEngine 2", SIGGRAPH
2007 courses. Where several pixels of a row are about as far, all are compared with pixels equally far away in
the image, so that the compiler can vectorize it. Most surfaces are even, and nothing around rises above them:
that is found out first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.shading.pixel_rows import Tilts, Vectors, View
from wildscav_engine.rendering.tracing.frustum import nonnegative

REACH = 0.5  # m, up to which other surfaces occlude
STRENGTH = 0.65
LEAST_RISE = 0.12  # sine of the angle above a surface below which nothing occludes it
NEARER = 0.35  # rows and columns of the diagonal samples, in shares of the reach
LEAST_HEIGHT = 0.5 * LEAST_RISE  # m above a surface per m to the side below which nothing occludes it
NONE, ONE = np.float32(0.0), np.float32(1.0)
RISE, SQUARE_OF_RISE = np.float32(LEAST_RISE), np.float32(LEAST_RISE * LEAST_RISE)
WIDTH, SQUARE_OF_WIDTH = np.float32(1.0 / (2.0 * REACH)), np.float32(4.0 * REACH * REACH)
APART = np.float32(2.0 * REACH)  # m, from where on nothing occludes
ALMOST = 0.98  # for rounding
NOWHERE = 1e15  # m, the depth of a pixel whose ray hits nothing
# Four straight beside the pixel, then four diagonally; the others are itself, so that loops vectorize evenly.
LOOKED_AT = 16
RIGHT = np.array([0, 0, -1, 1, -1, 1, -1, 1, *8 * [0]], np.int32)
DOWN = np.array([-1, 1, 0, 0, -1, -1, 1, 1, *8 * [0]], np.int32)
STRAIGHT = np.array([*4 * [1], *12 * [0]], np.int32)
LEAST, MOST = np.float32(0.87), np.float32(1.15)  # how far the others may be, in distances of the first


@kernel
def write_depths(
    distances: NDArray[np.float32], along: NDArray[np.float32], depths: NDArray[np.float32]
) -> None:
    """Write (H, W) m along the view axis, from distances along rays and the rays' cosines to that axis."""
    for row in range(depths.shape[0]):
        line, distance, cosine = depths[row], distances[row], along[row]
        for column in range(line.shape[0]):
            line[column] = min(np.float32(NOWHERE), distance[column] * cosine[column])


class Samples(NamedTuple):
    """The rows and columns of the pixels around one that are looked at, within the image."""

    over: int  # straight above the pixel
    under: int
    left: int
    right: int
    near_over: int  # on the diagonals
    near_under: int
    near_left: int
    near_right: int


@inlined_kernel
def reach_of(view: View, distance: float) -> float:
    """Return how many pixels around one that shows something so far away are looked at to each side."""
    return float(min(REACH / max(1e-6, distance * view.pixel), 0.2 * view.height))


@inlined_kernel
def samples_around(row: int, column: int, view: View, far: int, near: int) -> Samples:
    """Return the pixels that are looked at, so many to each side, and fewer diagonally."""
    last_row, last_column = view.height - 1, view.width - 1
    return Samples(
        max(0, row - far),
        min(last_row, row + far),
        max(0, column - far),
        min(last_column, column + far),
        max(0, row - near),
        min(last_row, row + near),
        max(0, column - near),
        min(last_column, column + near),
    )


class Span(NamedTuple):
    """Successive pixels of a row, C of them."""

    row: int
    first: int  # column
    depth: NDArray[np.float32]  # (C,) m along the view axis
    tilt: Tilts  # (C,)
    u: np.float32  # tangent of the angle to the right of the view axis, of the first
    v: np.float32  # the same upwards
    pixel: np.float32  # side of a pixel at distance 1 m


@inlined_kernel
def height_and_square(
    span: Span, column: int, depth: np.float32, aside: np.float32, above: np.float32
) -> tuple[np.float32, np.float32]:
    """Return how high in m what another pixel shows is above the surface, and the square of its distance."""
    here, tilt = span.depth[column], span.tilt
    plane = tilt.facing[column]
    height = depth * (plane + tilt.right[column] * aside + tilt.above[column] * above) - here * plane
    z, u = depth - here, span.u + np.float32(np.int32(column)) * span.pixel
    x, y = z * u + depth * aside, z * span.v + depth * above
    return height, x * x + y * y + z * z


@inlined_kernel
def occludes(height: np.float32, square: np.float32) -> np.int32:
    """Return 1 if ``occlusion`` is more than 0."""
    is_near = np.int32(height > NONE) & np.int32(square < SQUARE_OF_WIDTH)
    return is_near & np.int32(height * height > SQUARE_OF_RISE * square)


@inlined_kernel
def occlusion(height: np.float32, square: np.float32) -> np.float32:
    """Return how much a place occludes a surface, by its height in m above it and its squared distance."""
    length = np.sqrt(min(SQUARE_OF_WIDTH, square))  # as far away, nothing occludes
    steep = max(NONE, height / max(np.float32(1e-6), length) - RISE)
    return np.float32(steep * (ONE - length * WIDTH))


class Around(NamedTuple):
    """The pixels around one that are looked at, (LOOKED_AT,) each."""

    depth: NDArray[np.float32]  # m along the view axis
    aside: NDArray[np.float32]  # how far to the right of it, as a difference of tangents
    above: NDArray[np.float32]  # the same upwards
    taken: NDArray[np.float32]  # how much light each takes


@inlined_kernel
def unoccluded_share(
    depths: NDArray[np.float32],
    row: int,
    column: int,
    view: View,
    distance: float,
    tilt: Tilts,
    around: Around,
) -> np.float32:
    """Return the share of ambient light at a surface that nearby surfaces do not occlude, 0-1.

    Args:
        depths: (H, W) m along the view axis, NOWHERE where there is nothing.
        distance: m along the pixel's ray.
    """
    reach = reach_of(view, distance)
    if reach < 1.0:
        return ONE
    u, v = np.float32(view.left + column * view.pixel), np.float32(view.top - row * view.pixel)
    last = column + 1
    own = Tilts(tilt.right[column:last], tilt.above[column:last], tilt.facing[column:last])
    here = Span(row, column, depths[row][column:last], own, u, v, np.float32(view.pixel))
    # A single comparison, because on level surfaces all heights are near zero, above it or below by chance.
    least = np.float32(LEAST_HEIGHT * NEARER * reach * view.pixel) * here.depth[0]
    if not _rises_any(depths, here, view, reach, least):
        return ONE
    _look_around(depths, row, column, here.pixel, reach, around)
    if not _occludes_any(here, around, least):
        return ONE
    _note_taken(here, around)
    part = around.taken
    taken = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]))
    return max(NONE, ONE - np.float32(STRENGTH * 0.25 * min(1.0, reach - 1.0)) * taken)


@inlined_kernel
def _steepness(view: View) -> np.float32:
    """Return a height in m below which a pixel beside another occludes nothing, for all of an image.

    It is per m of depth and per tangent between the two: what pixels show is at least so far apart, times the
    least cosine of the view.
    """
    return np.float32(ALMOST * LEAST_RISE * view.least_cosine)


@inlined_kernel
def _rises_any(
    depths: NDArray[np.float32], here: Span, view: View, reach: float, least: np.float32
) -> np.int32:
    """Return 1 if any of the pixels around one may occlude it, and is at least so high in m above it."""
    row, column, steep = here.row, here.first, _steepness(view) * here.depth[0]
    at = samples_around(row, column, view, int(reach + 0.5), int(NEARER * reach + 0.5))
    straight = (
        _rises_at(depths, here, at.over, column, steep, least)
        | _rises_at(depths, here, at.under, column, steep, least)
        | _rises_at(depths, here, row, at.left, steep, least)
        | _rises_at(depths, here, row, at.right, steep, least)
    )
    return (
        straight
        | _rises_at(depths, here, at.near_over, at.near_left, steep, least)
        | _rises_at(depths, here, at.near_over, at.near_right, steep, least)
        | _rises_at(depths, here, at.near_under, at.near_left, steep, least)
        | _rises_at(depths, here, at.near_under, at.near_right, steep, least)
    )


@inlined_kernel
def _rises_at(
    depths: NDArray[np.float32], here: Span, row: int, column: int, steep: np.float32, least: np.float32
) -> np.int32:
    """Return 1 if a pixel is so high above another, in m, and in m per tangent between the two."""
    aside, above = _aside(here, column), _above(here, row)
    depth = depths[nonnegative(row), nonnegative(column)]
    height, _ = height_and_square(here, 0, depth, aside, above)
    is_high = np.int32(height >= least) & np.int32(height > steep * max(abs(aside), abs(above)))
    return is_high & _is_close(here.depth[0], depth)


@disjoint_kernel
def _look_around(
    depths: NDArray[np.float32], row: int, column: int, pixel: np.float32, reach: float, around: Around
) -> None:
    """Write where the pixels around one are, within the image, and how far away what they show."""
    last_row, last_column = np.int32(depths.shape[0] - 1), np.int32(depths.shape[1] - 1)
    far, near = np.int32(reach + 0.5), np.int32(NEARER * reach + 0.5)
    own_row, own_column, none = np.int32(row), np.int32(column), np.int32(0)
    for number in range(around.depth.shape[0]):
        away = far if STRAIGHT[number] else near
        other_row = min(last_row, max(none, own_row + away * DOWN[number]))
        other_column = min(last_column, max(none, own_column + away * RIGHT[number]))
        around.depth[number] = depths[nonnegative(other_row), nonnegative(other_column)]
        around.aside[number] = np.float32(np.int32(other_column - own_column)) * pixel
        around.above[number] = np.float32(np.int32(own_row - other_row)) * pixel


@disjoint_kernel
def _occludes_any(here: Span, around: Around, least: np.float32) -> bool:
    """Return whether any of the pixels around occludes a surface, and is at least so high in m above it."""
    is_any = np.int32(0)
    for number in range(around.depth.shape[0]):
        height, square = height_and_square(
            here, 0, around.depth[number], around.aside[number], around.above[number]
        )
        is_any |= occludes(height, square) & np.int32(height >= least)
    return bool(is_any != 0)


@disjoint_kernel
def _note_taken(here: Span, around: Around) -> None:
    for number in range(around.depth.shape[0]):
        height, square = height_and_square(
            here, 0, around.depth[number], around.aside[number], around.above[number]
        )
        around.taken[number] = occlusion(height, square)


@disjoint_kernel
def write_tilts(view: View, row: int, normal: Vectors, tilt: Tilts) -> None:
    """Write the planes of the surfaces of a row on the camera's axes."""
    sin_yaw, cos_yaw = np.float32(view.sin_yaw), np.float32(view.cos_yaw)
    sin_pitch, cos_pitch = np.float32(view.sin_pitch), np.float32(view.cos_pitch)
    left, pixel, v = np.float32(view.left), np.float32(view.pixel), np.float32(view.top - row * view.pixel)
    east, up, north = normal
    right, above, facing = tilt
    for column in range(right.shape[0]):
        right[column] = east[column] * cos_yaw - north[column] * sin_yaw
    for column in range(right.shape[0]):
        level = east[column] * sin_yaw + north[column] * cos_yaw
        above[column] = level * sin_pitch + up[column] * cos_pitch
    for column in range(right.shape[0]):
        level = east[column] * sin_yaw + north[column] * cos_yaw
        ahead = level * cos_pitch - up[column] * sin_pitch
        u = left + np.float32(np.int32(column)) * pixel
        facing[column] = right[column] * u + above[column] * v + ahead


@inlined_kernel
def are_alike_far(distances: NDArray[np.float32]) -> bool:
    """Return whether pixels with these distances along their rays can be looked at together."""
    near, far = distances[0] * LEAST, distances[0] * MOST
    is_other = np.int32(0)
    for column in range(distances.shape[0]):
        is_other |= np.int32(distances[column] < near) | np.int32(distances[column] > far)
    return bool(is_other == 0)


@inlined_kernel
def write_shares(
    depths: NDArray[np.float32],
    view: View,
    row: int,
    first: int,
    distance: float,
    tilt: Tilts,
    shares: NDArray[np.float32],
) -> None:
    """Write the shares of ambient light that nearby surfaces do not occlude, 0-1.

    All that is looked at, by ``reach_of`` the first pixel, must be in the image.

    Args:
        depths: (H, W) m along the view axis, NOWHERE where there is nothing.
        first: Column of the first of C pixels.
        distance: m along the ray of the first.
        shares: (C,), written.
    """
    last = first + shares.shape[0]
    own = Tilts(tilt.right[first:last], tilt.above[first:last], tilt.facing[first:last])
    u, v = np.float32(view.left + first * view.pixel), np.float32(view.top - row * view.pixel)
    span = Span(row, first, depths[row][first:last], own, u, v, np.float32(view.pixel))
    reach = reach_of(view, distance)
    at = samples_around(row, first, view, int(reach + 0.5), int(NEARER * reach + 0.5))
    if reach < 1.0 or not _rise_around(depths, span, at, _steepness(view)):
        shares[:] = ONE
        return
    shares[:] = NONE
    _add_occlusion(depths, span, at.over, first, shares)
    _add_occlusion(depths, span, at.under, first, shares)
    _add_occlusion(depths, span, row, at.left, shares)
    _add_occlusion(depths, span, row, at.right, shares)
    _add_occlusion(depths, span, at.near_over, at.near_left, shares)
    _add_occlusion(depths, span, at.near_over, at.near_right, shares)
    _add_occlusion(depths, span, at.near_under, at.near_left, shares)
    _add_occlusion(depths, span, at.near_under, at.near_right, shares)
    strength = np.float32(STRENGTH * 0.25 * min(1.0, reach - 1.0))
    for column in range(shares.shape[0]):
        shares[column] = max(NONE, ONE - strength * shares[column])


@disjoint_kernel
def _rise_around(depths: NDArray[np.float32], span: Span, at: Samples, steep: np.float32) -> bool:
    """Return whether any of the pixels around may occlude any of a span."""
    own, count, none = span.first, span.depth.shape[0], NONE
    left, right, near_left, near_right = at.left, at.right, at.near_left, at.near_right
    over, under = depths[at.over][own : own + count], depths[at.under][own : own + count]
    beside_left, beside_right = depths[span.row][left : left + count], depths[span.row][right : right + count]
    over_left = depths[at.near_over][near_left : near_left + count]
    over_right = depths[at.near_over][near_right : near_right + count]
    under_left = depths[at.near_under][near_left : near_left + count]
    under_right = depths[at.near_under][near_right : near_right + count]
    up, down = _above(span, at.over), _above(span, at.under)
    near_up, near_down = _above(span, at.near_over), _above(span, at.near_under)
    to_left, to_right = _aside(span, left), _aside(span, right)
    near_to_left, near_to_right = _aside(span, near_left), _aside(span, near_right)
    least, near_least = steep * up, steep * near_up
    rises = np.int32(0)
    for column in range(count):
        rises |= _rises(span, column, over[column], none, up, least)
        rises |= _rises(span, column, under[column], none, down, least)
        rises |= _rises(span, column, beside_left[column], to_left, none, least)
        rises |= _rises(span, column, beside_right[column], to_right, none, least)
        rises |= _rises(span, column, over_left[column], near_to_left, near_up, near_least)
        rises |= _rises(span, column, over_right[column], near_to_right, near_up, near_least)
        rises |= _rises(span, column, under_left[column], near_to_left, near_down, near_least)
        rises |= _rises(span, column, under_right[column], near_to_right, near_down, near_least)
    return bool(rises != 0)


@inlined_kernel
def _above(span: Span, row: int) -> np.float32:
    """Return how far above the span a row is, as a difference of tangents."""
    return np.float32(span.row - row) * span.pixel


@inlined_kernel
def _aside(span: Span, column: int) -> np.float32:
    """Return how far to the right of the first pixel a column is, as a difference of tangents."""
    return np.float32(column - span.first) * span.pixel


@inlined_kernel
def _rises(
    span: Span, column: int, depth: np.float32, aside: np.float32, above: np.float32, least: np.float32
) -> np.int32:
    """Return 1 if what another pixel shows is close, and higher than ``least`` times the depth of one."""
    height, _ = height_and_square(span, column, depth, aside, above)
    return np.int32(height > least * span.depth[column]) & _is_close(span.depth[column], depth)


@inlined_kernel
def _is_close(depth: np.float32, other: np.float32) -> np.int32:
    """Return 1 unless two depths alone show that neither place can occlude the other."""
    return np.int32(abs(other - depth) < APART)


@disjoint_kernel
def _add_occlusion(
    depths: NDArray[np.float32], span: Span, row: int, first: int, taken: NDArray[np.float32]
) -> None:
    """Add how much the pixels from one on occlude those of a span."""
    others, aside, above = depths[row][first : first + taken.shape[0]], _aside(span, first), _above(span, row)
    for column in range(taken.shape[0]):
        height, square = height_and_square(span, column, others[column], aside, above)
        taken[column] += occlusion(height, square)
