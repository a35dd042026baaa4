"""Ambient occlusion of several pixels of a row at once, where all are about as far.

It is that of ``ambient_occlusion``, but all are compared with pixels equally far away in the image, so that
the compiler can vectorize it. Most surfaces are even, and nothing around rises above them: that is found out
first.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel
from wildscav_engine.rendering.shading.ambient_occlusion import (
    NEARER,
    NONE,
    ONE,
    STRENGTH,
    Samples,
    Span,
    height_and_square,
    occludes,
    occlusion,
    reach_of,
    samples_around,
)
from wildscav_engine.rendering.shading.pixel_rays import View
from wildscav_engine.rendering.shading.pixel_rows import Normals, Tilts

LEAST, MOST = np.float32(0.87), np.float32(1.15)  # how far the others may be, in distances of the first


@disjoint_kernel
def write_tilts(view: View, row: int, normal: Normals, tilt: Tilts) -> None:
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
    if reach < 1.0 or not _rise_around(depths, span, at):
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
def _rise_around(depths: NDArray[np.float32], span: Span, at: Samples) -> bool:
    """Return whether any of the pixels around occludes any of a span."""
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
    rises = np.int32(0)
    for column in range(count):
        rises |= _rises(span, column, over[column], none, up)
        rises |= _rises(span, column, under[column], none, down)
        rises |= _rises(span, column, beside_left[column], to_left, none)
        rises |= _rises(span, column, beside_right[column], to_right, none)
        rises |= _rises(span, column, over_left[column], near_to_left, near_up)
        rises |= _rises(span, column, over_right[column], near_to_right, near_up)
        rises |= _rises(span, column, under_left[column], near_to_left, near_down)
        rises |= _rises(span, column, under_right[column], near_to_right, near_down)
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
def _rises(span: Span, column: int, depth: np.float32, aside: np.float32, above: np.float32) -> np.int32:
    """Return 1 if what another pixel shows, so far aside and above, occludes a pixel of a span."""
    height, square = height_and_square(span, column, depth, aside, above)
    return occludes(height, square)


@disjoint_kernel
def _add_occlusion(
    depths: NDArray[np.float32], span: Span, row: int, first: int, taken: NDArray[np.float32]
) -> None:
    """Add how much the pixels from one on occlude those of a span, as ``ambient_occlusion`` has it."""
    others, aside, above = depths[row][first : first + taken.shape[0]], _aside(span, first), _above(span, row)
    for column in range(taken.shape[0]):
        height, square = height_and_square(span, column, others[column], aside, above)
        taken[column] += occlusion(height, square)
