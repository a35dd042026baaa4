"""The view frustum of a camera: which pixels a part of the world may cover.

Everything here is conservative: rays of pixels that are left out certainly miss, others may hit.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel

NEAREST = 1e-9  # m ahead of the camera; nearer points and points behind have no position on the image
TOUCH = 1e-6  # m
MARGIN = 1e-3  # pixels by which everything is enlarged at least, to allow for rounding


Point = tuple[float, float, float]  # m


class Camera(NamedTuple):
    """A camera at one place, looking in one direction: a pinhole, or one that sees a sector of a panorama.

    A ray with the tangent x to its right belongs to the column at x (scale + curve x²) from the middle of the
    image. One with the tangent y upwards belongs to a row above ``level`` by y scale_up, give or take
    |y| spread. The centres of columns and rows differ from that by less than the margins.
    """

    x: float  # m
    y: float
    z: float
    sin_yaw: float
    cos_yaw: float
    sin_pitch: float
    cos_pitch: float
    scale: float  # columns per unit of tangent
    curve: float  # 0 for a pinhole
    scale_up: float  # rows per unit of tangent
    spread: float  # rows per unit of tangent, 0 for a pinhole
    level: float  # rows from the top of the image to where the tangent is 0
    width: int  # pixels
    height: int
    half_width: float  # tangents of half the fields of view
    half_height: float
    slant_x: float  # how much wider a sphere seems at the left and right edges of the image
    slant_y: float  # the same at the top and bottom
    far: float  # m along a ray, the greatest distance of a hit
    margin: float  # columns by which everything is enlarged
    margin_up: float  # rows by which everything is enlarged


class Optics(NamedTuple):
    """How a camera maps tangents to columns and rows; see ``Camera``."""

    scale: float
    curve: float
    scale_up: float
    spread: float
    level: float
    half_width: float
    half_height: float
    margin: float  # in addition to MARGIN, like the next
    margin_up: float


class Rectangle(NamedTuple):
    """A rectangle of pixels; empty unless ``left`` is less than ``right``."""

    left: int
    right: int  # one past the last column
    top: int
    bottom: int  # one past the last row


class Outline(NamedTuple):
    """The bounds of some points in a camera's axes (right, above, ahead) and on its image (tangents)."""

    left: float  # tangents, of the points ahead only
    right: float
    lowest: float
    highest: float
    x_least: float  # m
    x_most: float
    y_least: float
    y_most: float
    nearest: float  # m ahead
    farthest: float


@inlined_kernel
def nonnegative(number: int) -> int:
    """Return a number known to lie between 0 and 2³¹ - 1, in a form that shows the compiler that it does.

    Otherwise each index would be checked for being negative, which in Python counts from an array's end.
    """
    return number & 0x7FFFFFFF


@inlined_kernel
def lowest_bit(bits: int) -> int:
    """Return the number of the lowest of the 64 bits of a number that are set: the exponent of its value."""
    value = np.float64(bits & -bits)
    return int(((value.view(np.int64) >> 52) & 0x7FF) - 1023)


@inlined_kernel
def pinhole(half_width: float, width: int, height: int) -> Optics:
    """Return the optics of a pinhole; see ``Cameras`` for its half width."""
    scale = width / (2.0 * half_width)
    half_height = half_width * height / width
    return Optics(scale, 0.0, scale, 0.0, height * 0.5, half_width, half_height, 0.0, 0.0)


@inlined_kernel
def camera_at(
    eye: NDArray[np.float64],
    yaw: float,
    pitch: float,
    optics: Optics,
    width: int,
    height: int,
    far: float,
) -> Camera:
    """Return the camera at an eye (3,) m, with angles in degrees."""
    return Camera(
        eye[0],
        eye[1],
        eye[2],
        sine(yaw),
        cosine(yaw),
        sine(pitch),
        cosine(pitch),
        optics.scale,
        optics.curve,
        optics.scale_up,
        optics.spread,
        optics.level,
        width,
        height,
        optics.half_width,
        optics.half_height,
        np.sqrt(1.0 + optics.half_width * optics.half_width),
        np.sqrt(1.0 + optics.half_height * optics.half_height),
        far,
        MARGIN + optics.margin,
        MARGIN + optics.margin_up,
    )


@inlined_kernel
def point_in_camera_axes(camera: Camera, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a point of the world in the camera's axes: m to its right, above it and ahead of it."""
    return to_camera_axes(camera, x - camera.x, y - camera.y, z - camera.z)


@inlined_kernel
def to_camera_axes(camera: Camera, east: float, up: float, north: float) -> tuple[float, float, float]:
    """Return the vector from a camera to a point in the camera's axes: right, above, ahead."""
    level = camera.sin_yaw * east + camera.cos_yaw * north
    return (
        camera.cos_yaw * east - camera.sin_yaw * north,
        camera.cos_pitch * up + camera.sin_pitch * level,
        camera.cos_pitch * level - camera.sin_pitch * up,
    )


@inlined_kernel
def may_show(camera: Camera, x: float, y: float, z: float, radius: float) -> bool:
    """Return whether a sphere in the world, m, may reach into the view frustum."""
    right, above, ahead = point_in_camera_axes(camera, x, y, z)
    is_outside_view = abs(right) - camera.half_width * ahead - radius * camera.slant_x
    beyond = abs(above) - camera.half_height * ahead - radius * camera.slant_y
    # A single comparison avoids branch mispredictions.
    return max(is_outside_view, beyond, -ahead - radius, ahead - camera.far - radius) <= 0.0


@inlined_kernel
def is_outside_view(camera: Camera, a: Point, b: Point, c: Point, d: Point) -> bool:
    """Return whether four points in a camera's axes all lie outside one of the planes of its frustum."""
    wide, tall = camera.half_width, camera.half_height
    left = max(a[0] + wide * a[2], b[0] + wide * b[2], c[0] + wide * c[2], d[0] + wide * d[2])
    right = min(a[0] - wide * a[2], b[0] - wide * b[2], c[0] - wide * c[2], d[0] - wide * d[2])
    below = max(a[1] + tall * a[2], b[1] + tall * b[2], c[1] + tall * c[2], d[1] + tall * d[2])
    above = min(a[1] - tall * a[2], b[1] - tall * b[2], c[1] - tall * c[2], d[1] - tall * d[2])
    return max(right, -left, above, -below, -max(a[2], b[2], c[2], d[2])) > TOUCH


@inlined_kernel
def empty_outline() -> Outline:
    """Return the bounds of no points."""
    most = np.inf
    return Outline(most, -most, most, -most, most, -most, most, -most, most, -most)


@inlined_kernel
def extended(outline: Outline, point: tuple[float, float, float]) -> Outline:
    """Return an outline extended by one more point, in the camera's axes."""
    x, y, z = point
    inverse = 1.0 / z
    u, v, is_ahead = x * inverse, y * inverse, z > NEAREST
    return Outline(
        min(outline.left, u if is_ahead else np.inf),
        max(outline.right, u if is_ahead else -np.inf),
        min(outline.lowest, v if is_ahead else np.inf),
        max(outline.highest, v if is_ahead else -np.inf),
        min(outline.x_least, x),
        max(outline.x_most, x),
        min(outline.y_least, y),
        max(outline.y_most, y),
        min(outline.nearest, z),
        max(outline.farthest, z),
    )


@inlined_kernel
def outline_of_box(camera: Camera, box: NDArray[np.float64]) -> Outline:
    """Return the outline of a box (9,) rotated about its vertical axis; see ``Shapes``."""
    east, up, north = box[0] - camera.x, box[1] - camera.y, box[2] - camera.z
    outline = empty_outline()
    for corner in range(4):
        a, c = (1.0 if corner & 1 else -1.0), (1.0 if corner & 2 else -1.0)
        x, z = east + a * box[5] + c * box[7], north + a * box[6] + c * box[8]
        outline = _with_edge(camera, outline, x, z, up, box[4])
    return outline


@inlined_kernel
def _with_edge(
    camera: Camera, outline: Outline, east: float, north: float, up: float, half: float
) -> Outline:
    """Return an outline extended by the ends of a vertical edge.

    The edge's middle is given in m from the camera. Its distance to the right does not depend on the height,
    because cameras do not roll.
    """
    right, above, ahead = to_camera_axes(camera, east, up, north)
    rise, run = camera.cos_pitch * half, camera.sin_pitch * half
    outline = extended(outline, (right, above + rise, ahead - run))
    return extended(outline, (right, above - rise, ahead + run))


@inlined_kernel
def pixels_of(camera: Camera, outline: Outline) -> Rectangle:
    """Return the pixels whose centres may lie in the convex hull of an outline's points."""
    if _is_around_eye(outline):
        return Rectangle(0, camera.width, 0, camera.height)
    left, right, lowest, highest = outline.left, outline.right, outline.lowest, outline.highest
    if outline.farthest <= NEAREST:
        return Rectangle(0, 0, 0, 0)
    if outline.nearest <= NEAREST:
        # The section by the plane at NEAREST lies within the bounds of all points.
        left, right = min(left, outline.x_least / NEAREST), max(right, outline.x_most / NEAREST)
        lowest, highest = min(lowest, outline.y_least / NEAREST), max(highest, outline.y_most / NEAREST)
    return pixels_between(camera, left, right, lowest, highest)


@inlined_kernel
def _is_around_eye(outline: Outline) -> bool:
    """Return whether the eye may be in or on the hull of the points: then all rays hit it there."""
    return (
        max(outline.x_least, outline.y_least, outline.nearest) <= TOUCH
        and min(outline.x_most, outline.y_most, outline.farthest) >= -TOUCH
    )


@inlined_kernel
def pixels_between(camera: Camera, left: float, right: float, lowest: float, highest: float) -> Rectangle:
    """Return the pixels whose centres lie between some tangents."""
    half_width = camera.width * 0.5
    left, right = max(-camera.half_width, left), min(camera.half_width, right)
    left = left * (camera.scale + camera.curve * left * left)
    right = right * (camera.scale + camera.curve * right * right)
    first = max(0.0, np.ceil(half_width + left - 0.5 - camera.margin))
    last = min(camera.width - 1.0, np.floor(half_width + right - 0.5 + camera.margin))
    level = camera.level - 0.5
    highest = highest * camera.scale_up + abs(highest) * camera.spread
    lowest = lowest * camera.scale_up - abs(lowest) * camera.spread
    top = max(0.0, np.ceil(level - highest - camera.margin_up))
    bottom = min(camera.height - 1.0, np.floor(level - lowest + camera.margin_up))
    if first > last or top > bottom:
        return Rectangle(0, 0, 0, 0)
    return Rectangle(int(first), int(last) + 1, int(top), int(bottom) + 1)
