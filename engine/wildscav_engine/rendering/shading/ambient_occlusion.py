"""Screen-space ambient occlusion: less light in corners, where a wall meets a floor or a foot the ground.

It uses what nearby pixels hit, so it casts no rays. After Mittring, "Finding Next Gen: CryEngine 2", SIGGRAPH
2007 courses.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.shading.color_arithmetic import Vector
from wildscav_engine.rendering.shading.pixel_rays import View
from wildscav_engine.rendering.tracing.frustum import nonnegative

REACH = 0.5  # m, up to which other surfaces occlude
STRENGTH = 0.65
LEAST_RISE = 0.12  # sine of the angle above a surface below which nothing occludes it
NEARER = 0.35  # rows and columns of the diagonal samples, in shares of the reach
LEAST_HEIGHT = 0.5 * LEAST_RISE  # m above a surface per m to the side below which nothing occludes it
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


class Corner(NamedTuple):
    """A surface that others may occlude, on the camera's axes.

    The place that a pixel shows is its depth times (u, v, 1), with tangents u to the right and v upwards.
    """

    depth: float  # m along the view axis
    u: float
    v: float
    right: float  # its normal
    above: float
    ahead: float
    offset: float  # m, of its plane


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
def unoccluded_share(
    depths: NDArray[np.float32], row: int, column: int, view: View, distance: float, normal: Vector
) -> float:
    """Return the share of ambient light at a surface that nearby surfaces do not occlude, 0-1.

    Args:
        depths: (H, W) m along the view axis, NOWHERE where there is nothing.
        row: Of the pixel.
        column: Of the pixel.
        view: The camera of the image.
        distance: m along the pixel's ray.
        normal: Unit normal of the surface there.
    """
    reach = reach_of(view, distance)
    if reach < 1.0:
        return 1.0
    at = samples_around(row, column, view, int(reach + 0.5), int(NEARER * reach + 0.5))
    here = _corner_at(view, float(depths[row, column]), row, column, normal)
    straight = max(
        _height(depths, view, here, at.over, column),
        _height(depths, view, here, at.under, column),
        _height(depths, view, here, row, at.left),
        _height(depths, view, here, row, at.right),
    )
    diagonal = max(
        _height(depths, view, here, at.near_over, at.near_left),
        _height(depths, view, here, at.near_over, at.near_right),
        _height(depths, view, here, at.near_under, at.near_left),
        _height(depths, view, here, at.near_under, at.near_right),
    )
    # A single comparison, because on level surfaces all heights are near zero, above it or below by chance.
    if max(straight, diagonal) < LEAST_HEIGHT * NEARER * reach * view.pixel * here.depth:
        return 1.0
    taken = (
        _occlusion(depths, view, here, at.over, column)
        + _occlusion(depths, view, here, at.under, column)
        + _occlusion(depths, view, here, row, at.left)
        + _occlusion(depths, view, here, row, at.right)
        + _occlusion(depths, view, here, at.near_over, at.near_left)
        + _occlusion(depths, view, here, at.near_over, at.near_right)
        + _occlusion(depths, view, here, at.near_under, at.near_left)
        + _occlusion(depths, view, here, at.near_under, at.near_right)
    )
    return max(0.0, 1.0 - STRENGTH * taken * 0.25 * min(1.0, reach - 1.0))


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


@inlined_kernel
def _corner_at(view: View, depth: float, row: int, column: int, normal: Vector) -> Corner:
    right = normal[0] * view.cos_yaw - normal[2] * view.sin_yaw
    level = normal[0] * view.sin_yaw + normal[2] * view.cos_yaw
    ahead = level * view.cos_pitch - normal[1] * view.sin_pitch
    above = level * view.sin_pitch + normal[1] * view.cos_pitch
    u, v = view.left + column * view.pixel, view.top - row * view.pixel
    return Corner(depth, u, v, right, above, ahead, depth * (right * u + above * v + ahead))


@inlined_kernel
def _height(depths: NDArray[np.float32], view: View, here: Corner, row: int, column: int) -> float:
    """Return how high in m the place that a pixel shows is above a surface."""
    u, v = view.left + column * view.pixel, view.top - row * view.pixel
    depth = float(depths[nonnegative(row), nonnegative(column)])
    return depth * (here.right * u + here.above * v + here.ahead) - here.offset


@inlined_kernel
def _occlusion(depths: NDArray[np.float32], view: View, here: Corner, row: int, column: int) -> float:
    """Return how much the place that a pixel shows occludes a surface, by its height and distance."""
    height = _height(depths, view, here, row, column)
    depth = float(depths[nonnegative(row), nonnegative(column)])
    x = depth * (view.left + column * view.pixel) - here.depth * here.u
    y = depth * (view.top - row * view.pixel) - here.depth * here.v
    z = depth - here.depth
    square = x * x + y * y + z * z
    if height <= 0.0 or square >= 4.0 * REACH * REACH:
        return 0.0
    length = np.sqrt(square)
    return float(max(0.0, height / length - LEAST_RISE) * (1.0 - length / (2.0 * REACH)))
