"""Screen-space ambient occlusion: less light in corners, where a wall meets a floor or a foot the ground.

It uses what nearby pixels hit, so it casts no rays. After Mittring, "Finding Next Gen: CryEngine 2", SIGGRAPH
2007 courses.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.rendering.shading.pixel_rays import View
from wildscav_engine.rendering.shading.pixel_rows import Tilts
from wildscav_engine.rendering.tracing.frustum import nonnegative

REACH = 0.5  # m, up to which other surfaces occlude
STRENGTH = 0.65
LEAST_RISE = 0.12  # sine of the angle above a surface below which nothing occludes it
NEARER = 0.35  # rows and columns of the diagonal samples, in shares of the reach
LEAST_HEIGHT = 0.5 * LEAST_RISE  # m above a surface per m to the side below which nothing occludes it
NONE, ONE = np.float32(0.0), np.float32(1.0)
RISE, SQUARE_OF_RISE = np.float32(LEAST_RISE), np.float32(LEAST_RISE * LEAST_RISE)
WIDTH, SQUARE_OF_WIDTH = np.float32(1.0 / (2.0 * REACH)), np.float32(4.0 * REACH * REACH)
NOWHERE = 1e15  # m, the depth of a pixel whose ray hits nothing


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


# Four straight beside the pixel, then four diagonally; the others are itself, so that loops vectorize evenly.
LOOKED_AT = 16
RIGHT = np.array([0, 0, -1, 1, -1, 1, -1, 1, *8 * [0]], np.int32)
DOWN = np.array([-1, 1, 0, 0, -1, -1, 1, 1, *8 * [0]], np.int32)
STRAIGHT = np.array([*4 * [1], *12 * [0]], np.int32)


@inlined_kernel
def around_in(space: NDArray[np.float32]) -> Around:
    """Return the buffers in (4, LOOKED_AT) numbers."""
    return Around(space[0], space[1], space[2], space[3])


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
    _look_around(depths, row, column, np.float32(view.pixel), reach, around)
    u, v = np.float32(view.left + column * view.pixel), np.float32(view.top - row * view.pixel)
    last = column + 1
    own = Tilts(tilt.right[column:last], tilt.above[column:last], tilt.facing[column:last])
    here = Span(row, column, depths[row][column:last], own, u, v, np.float32(view.pixel))
    # A single comparison, because on level surfaces all heights are near zero, above it or below by chance.
    least = np.float32(LEAST_HEIGHT * NEARER * reach * view.pixel) * here.depth[0]
    if not _occludes_any(here, around, least):
        return ONE
    _note_taken(here, around)
    part = around.taken
    taken = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]))
    return max(NONE, ONE - np.float32(STRENGTH * 0.25 * min(1.0, reach - 1.0)) * taken)


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
