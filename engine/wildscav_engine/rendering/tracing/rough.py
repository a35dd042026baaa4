"""Where boxes lie on an image, half as precise as all else and so twice as fast, eight at once.

It only says which pixels to look at. As in ``frustum``, everything is cautious; what is near the camera is
left to be placed precisely.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.rendering.tracing.frustum import Camera, Rectangle
from wildscav_engine.rendering.tracing.packing import GROUP, LANES

NEAR = 1.0  # m; what is nearer ahead is placed precisely
NEAR_RADII = 1.0 / 16.0  # so many radii of what is large are near, too, for it is rounded more
ROUNDED = 2e-5  # of the tangent of what is farther, the most by which rounding changes it
SLACK = 1e-2  # m and pixels that rounding changes at most of all else
NEVER_SEEN = -1e30  # m, radius of what is not there
# Room for a group of boxes, and, each starting here, for where on an image they lie: first and last columns
# and rows of pixels; m to the nearest corner ahead; whether one may be seen; and whether it is near.
FIRST, LAST, TOP, BOTTOM, NEAREST, SHOWN, IS_NEAR = (GROUP + LANES * row for row in range(7))
ROOM = GROUP + 7 * LANES


class RoughCamera(NamedTuple):
    """A camera half as precise; all float32."""

    sin_yaw: np.float32
    cos_yaw: np.float32
    sin_pitch: np.float32
    cos_pitch: np.float32
    half_width: np.float32  # see Camera
    half_height: np.float32
    slant_x: np.float32
    slant_y: np.float32
    far: np.float32
    scale: np.float32
    last_column: np.float32
    last_row: np.float32
    left: np.float32  # columns at tangent 0, where a pixel begins to be touched, and where it ends
    right: np.float32
    top: np.float32  # likewise rows
    bottom: np.float32


@inlined_kernel
def roughly(camera: Camera) -> RoughCamera:
    """Return a camera half as precise."""
    margin = SLACK + ROUNDED * camera.scale
    column, row = camera.width * 0.5 - 0.5, camera.height * 0.5 - 0.5
    return RoughCamera(
        np.float32(camera.sin_yaw),
        np.float32(camera.cos_yaw),
        np.float32(camera.sin_pitch),
        np.float32(camera.cos_pitch),
        np.float32(camera.half_width),
        np.float32(camera.half_height),
        np.float32(camera.slant_x),
        np.float32(camera.slant_y),
        np.float32(camera.far + SLACK),
        np.float32(camera.scale),
        np.float32(camera.width - 1),
        np.float32(camera.height - 1),
        np.float32(column - margin),
        np.float32(column + margin),
        np.float32(row - margin),
        np.float32(row + margin),
    )


@inlined_kernel
def ball_shows(
    camera: RoughCamera, right: np.float32, above: np.float32, ahead: np.float32, radius: np.float32
) -> bool:
    """Return whether a ball in the camera's axes, m, reaches into what the camera sees."""
    beside = abs(right) - camera.half_width * ahead - radius * camera.slant_x
    beyond = abs(above) - camera.half_height * ahead - radius * camera.slant_y
    # One comparison: of several, some would often be guessed wrong by the processor.
    return bool(max(beside, beyond, -ahead - radius, ahead - camera.far - radius) <= np.float32(0.0))


@kernel
def place_boxes(
    east: np.float32, up: np.float32, north: np.float32, camera: RoughCamera, boxes: NDArray[np.float32]
) -> None:
    """Say where eight boxes lie on an image.

    Args:
        east: float32 m from the camera to where the boxes count from; so up and north.
        up: See east.
        north: See east.
        camera: The image's.
        boxes: (ROOM,) a group, see ``Blocks``, and where it lies, written. One array for both: so they surely
            do not overlap, which would keep so short a loop from being done at once.
    """
    sin_yaw, cos_yaw, sin_pitch, cos_pitch = (
        camera.sin_yaw,
        camera.cos_yaw,
        camera.sin_pitch,
        camera.cos_pitch,
    )
    zero, one = np.float32(0.0), np.float32(1.0)
    near, near_radii = np.float32(NEAR), np.float32(NEAR_RADII)
    for lane in range(LANES):
        x, y, z = east + boxes[lane], up + boxes[LANES + lane], north + boxes[2 * LANES + lane]
        half, radius = boxes[3 * LANES + lane], boxes[8 * LANES + lane]
        ax, az = boxes[4 * LANES + lane], boxes[5 * LANES + lane]
        bx, bz = boxes[6 * LANES + lane], boxes[7 * LANES + lane]
        level, right = sin_yaw * x + cos_yaw * z, cos_yaw * x - sin_yaw * z
        a_level, a_right = sin_yaw * ax + cos_yaw * az, cos_yaw * ax - sin_yaw * az
        b_level, b_right = sin_yaw * bx + cos_yaw * bz, cos_yaw * bx - sin_yaw * bz
        rise, run = cos_pitch * half, sin_pitch * half
        above, ahead = cos_pitch * y + sin_pitch * level, cos_pitch * level - sin_pitch * y
        # The middles of the four upright edges: to the right, above and ahead; then the ends of each.
        r0, r1 = right - a_right - b_right, right + a_right - b_right
        r2, r3 = right - a_right + b_right, right + a_right + b_right
        l0, l1 = -a_level - b_level, a_level - b_level
        l2, l3 = -a_level + b_level, a_level + b_level
        z0, z1 = ahead + cos_pitch * l0, ahead + cos_pitch * l1
        z2, z3 = ahead + cos_pitch * l2, ahead + cos_pitch * l3
        y0, y1 = above + sin_pitch * l0, above + sin_pitch * l1
        y2, y3 = above + sin_pitch * l2, above + sin_pitch * l3
        nearest = min(z0, z1, z2, z3) - abs(run)
        t0, t1, t2, t3 = one / (z0 - run), one / (z1 - run), one / (z2 - run), one / (z3 - run)
        b0, b1, b2, b3 = one / (z0 + run), one / (z1 + run), one / (z2 + run), one / (z3 + run)
        least = min(r0 * t0, r1 * t1, r2 * t2, r3 * t3, r0 * b0, r1 * b1, r2 * b2, r3 * b3)
        most = max(r0 * t0, r1 * t1, r2 * t2, r3 * t3, r0 * b0, r1 * b1, r2 * b2, r3 * b3)
        u0, u1, u2, u3 = (y0 + rise) * t0, (y1 + rise) * t1, (y2 + rise) * t2, (y3 + rise) * t3
        d0, d1, d2, d3 = (y0 - rise) * b0, (y1 - rise) * b1, (y2 - rise) * b2, (y3 - rise) * b3
        highest = max(u0, u1, u2, u3, d0, d1, d2, d3)
        lowest = min(u0, u1, u2, u3, d0, d1, d2, d3)
        first = max(zero, np.ceil(camera.left + least * camera.scale))
        last = min(camera.last_column, np.floor(camera.right + most * camera.scale))
        top = max(zero, np.ceil(camera.top - highest * camera.scale))
        bottom = min(camera.last_row, np.floor(camera.bottom - lowest * camera.scale))
        is_near = nearest <= max(near, near_radii * radius)
        has_pixels = (first <= last) & (top <= bottom)
        shows = ball_shows(camera, right, above, ahead, radius)
        boxes[FIRST + lane], boxes[LAST + lane] = first, last
        boxes[TOP + lane], boxes[BOTTOM + lane] = top, bottom
        boxes[NEAREST + lane] = nearest
        boxes[SHOWN + lane] = np.float32(shows & (is_near | has_pixels))
        boxes[IS_NEAR + lane] = np.float32(is_near)


@inlined_kernel
def is_shown(boxes: NDArray[np.float32], lane: int) -> bool:
    """Return whether one of the boxes may be seen."""
    return bool(boxes[SHOWN + lane] > np.float32(0.0))


@inlined_kernel
def is_near(boxes: NDArray[np.float32], lane: int) -> bool:
    """Return whether one of the boxes that may be seen is still to be placed precisely."""
    return bool(boxes[IS_NEAR + lane] > np.float32(0.0))


@inlined_kernel
def pixels_at(boxes: NDArray[np.float32], lane: int) -> Rectangle:
    """Return the pixels of one of the boxes that may be seen and is not near."""
    return Rectangle(
        int(boxes[FIRST + lane]),
        int(boxes[LAST + lane]) + 1,
        int(boxes[TOP + lane]),
        int(boxes[BOTTOM + lane]) + 1,
    )


@inlined_kernel
def distance_at(boxes: NDArray[np.float32], lane: int) -> float:
    """Return m that one of the boxes is ahead at least."""
    return float(boxes[NEAREST + lane]) * (1.0 - ROUNDED) - SLACK
