"""Procedural textures of solids: boards, tiles, courses of stone, and spots.

Details finer than a pixel fade out, so that they do not flicker. Boards of floors and stairs and tiles of
roofs are drawn pixel by pixel; walls, plants, rocks and furniture along a row of pixels, in loops that
vectorize.
"""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import disjoint_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clamp, lerp, scaled
from wildscav_engine.rendering.shading.noise import (
    FOURS,
    between,
    corner_of,
    eased32,
    grain,
    noise,
    sharpness,
    sharpness32,
    write_seen,
)
from wildscav_engine.rendering.shading.pixel_rows import (
    AT_ONCE,
    Channels,
    TextureScratch,
    Vectors,
    View,
    vectors_in,
    write_footprints,
    write_places,
)
from wildscav_engine.rendering.tracing.frustum import nonnegative

FLOOR, STAIR, ROOF = int(Kind.FLOOR), int(Kind.STAIR), int(Kind.ROOF)
CEILING = (226.0, 222.0, 212.0)
LEVEL = 0.9  # least upward part of the normal of a face that can be walked on
WALL = int(Kind.WALL)
NONE, QUARTER, HALF, ONE, TWO = (np.float32(number) for number in (0.0, 0.25, 0.5, 1.0, 2.0))
TOGETHER = 16  # float32 numbers that a processor computes at once, at most
FLAT = 0.995  # least upward part of the normal of a flat roof
STEEP = 0.5  # least level part of the normal of a wall with courses of stone
# The courses of a wall and the stones in them: m high and long, m by which every other course is displaced.
HIGH, LONG, DISPLACED = np.float32(0.32), np.float32(0.62), np.float32(0.31)
JOINT = np.float32(0.016)  # m, width of the joints between stones
OF_JOINTS, OF_STONES = np.float32(0.13), np.float32(0.07)  # differences in brightness
# The spots of each kind of solid: their size in m, how much flatter than wide they are, and between the
# darkest and the brightest; then the same of larger ones.
SPOTS = np.zeros((len(Kind), 2, 3), np.float32)
SPOTS[Kind.WALL, 0] = 0.9, 1.0, 0.07
SPOTS[Kind.ROOF] = (0.15, 1.0, 0.20), (1.2, 1.0, 0.12)  # where it is flat
SPOTS[Kind.FURNITURE, 0] = 0.14, 6.0, 0.22
SPOTS[Kind.TRUNK, 0] = 0.09, 0.22, 0.50
SPOTS[Kind.CROWN] = SPOTS[Kind.BUSH] = (0.20, 1.0, 0.55), (0.75, 1.0, 0.30)
SPOTS[Kind.ROCK] = (0.12, 1.0, 0.30), (0.60, 1.0, 0.24)
HAS_SPOTS = SPOTS[:, 0, 2] > 0.0


@inlined_kernel
def textured(kind: int, color: Color, normal: Vector, place: Vector, axis: Vector, pixel: float) -> Color:
    """Return the colour of a solid's surface at a place.

    Args:
        place: m, on the map.
        axis: Level unit vector that its boards run along.
        pixel: m, the size of a pixel there.
    """
    x, _, z = place
    across = axis[2] * x - axis[0] * z
    along = axis[0] * x + axis[2] * z
    if kind == FLOOR:
        if normal[1] < -0.5:
            return lerp(color, CEILING, 0.8)
        return _boarded(color, across, along, 0.18, pixel) if normal[1] > 0.5 else scaled(color, 0.8)
    if kind == STAIR:
        return _boarded(color, along, across, 0.3, pixel) if normal[1] > 0.5 else scaled(color, 0.68)
    if kind == ROOF:
        return _tiled(color, normal, place, pixel)
    return color


@inlined_kernel
def _line(coordinate: float, spacing: float, width: float, pixel: float) -> float:
    """Return the share of a pixel that evenly spaced lines cover, 0-1; all lengths in m."""
    phase = coordinate * (1.0 / spacing)
    aside = abs(phase - math.floor(phase + 0.5)) * spacing
    soft = max(0.5 * pixel, 0.25 * width)
    return clamp((0.5 * width + soft - aside) / (2.0 * soft), 0.0, 1.0) * sharpness(spacing, pixel)


@inlined_kernel
def _boarded(color: Color, across: float, along: float, width: float, pixel: float) -> Color:
    """Return the colour of boards side by side, each of its own brightness, with dark joints."""
    board = math.floor(across * (1.0 / width))
    length = math.floor(along * (1.0 / 2.6) + grain(board, 7, 3))
    own = 1.0 + 0.18 * (grain(board, length, 11) - 0.5) * sharpness(width, pixel)
    joint = _line(across, width, 0.014, pixel)
    fibre = 0.10 * (noise(across * (1.0 / 0.03), along * 2.0) - 0.5) * sharpness(0.05, pixel)
    return scaled(color, (own + fibre) * (1.0 - 0.40 * joint))


@inlined_kernel
def _tiled(color: Color, normal: Vector, place: Vector, pixel: float) -> Color:
    """Return the colour of rows of tiles, dark at their lower edges; plain under eaves."""
    if normal[1] < 0.05:
        return scaled(color, 0.62)
    level = np.sqrt(normal[0] * normal[0] + normal[2] * normal[2])
    # The distances up the slope and along the eaves.
    up, along = place[1] / level, (normal[2] * place[0] - normal[0] * place[2]) / level
    row = math.floor(up / 0.34)
    along += 0.14 * (row & 1)
    column = math.floor(along / 0.28)
    seen = sharpness(0.34, pixel)
    own = 1.0 + seen * (0.22 * (grain(row, column, 2) - 0.5) + 0.16 * (up / 0.34 - row - 0.5))
    joint = max(_line(up, 0.34, 0.03, pixel), 0.6 * _line(along, 0.28, 0.02, pixel))
    return scaled(color, own * (1.0 - 0.38 * joint))


@inlined_kernel
def has_spots(kind: int, normal: Vector) -> bool:
    """Return whether a face of a solid is drawn here, not in ``surfaces``."""
    return bool(HAS_SPOTS[kind]) and (kind != ROOF or normal[1] > FLAT)


@kernel
def write_spotted(
    kind: int,
    color: Color,
    normal: Vectors,
    view: View,
    ways: Vectors,
    distances: NDArray[np.float32],
    scratch: TextureScratch,
    shown: Channels,
) -> None:
    """Write the colours without light of a face of a solid, in a piece of a row of C pixels.

    Args:
        normal: (C,) the unit normal of the face, which is the same everywhere.
        distances: (C,) m along their rays.
        shown: (C,) written.
    """
    to_east, to_north = float(normal.east[0]), float(normal.north[0])
    level = np.sqrt(to_east * to_east + to_north * to_north)
    for start in range(0, distances.shape[0], AT_ONCE):
        end = min(distances.shape[0], start + AT_ONCE)
        some, facing = vectors_in(ways, start, end), vectors_in(normal, start, end)
        even = -(-(end - start) // TOGETHER) * TOGETHER
        write_places(view, some, distances[start:end], scratch)
        write_footprints(view, some, distances[start:end], facing, scratch)
        if kind == WALL and level >= STEEP:
            _write_courses(even, to_north / level, to_east / level, scratch)
        else:
            scratch.grain[:even] = ONE
        for number in range(2):
            if SPOTS[kind, number, 2] > NONE:
                _add_spots(SPOTS[kind, number], end - start, even, scratch)
        _write_shown(np.float32(color[0]), scratch.grain, shown.red[start:end])
        _write_shown(np.float32(color[1]), scratch.grain, shown.green[start:end])
        _write_shown(np.float32(color[2]), scratch.grain, shown.blue[start:end])


@disjoint_kernel
def _write_courses(even: int, along_east: float, along_north: float, scratch: TextureScratch) -> None:
    """Write how bright plaster is over barely visible courses of stone, along a wall in some direction."""
    x, y, z, pixel, bright = scratch.x, scratch.y, scratch.z, scratch.pixel, scratch.grain
    east, north = np.float32(along_east), np.float32(along_north)
    for column in range(even):
        course = np.int32(np.floor(y[column] * (ONE / HIGH)))
        along = east * x[column] - north * z[column] + DISPLACED * np.float32(course & 1)
        stone = np.int32(np.floor(along * (ONE / LONG)))
        joint = max(_joint(y[column], HIGH, pixel[column]), _joint(along, LONG, pixel[column]))
        own = np.float32(grain(int(course), int(stone), 5)) - HALF
        own = ONE + OF_STONES * own * sharpness32(HIGH, pixel[column])
        bright[column] = own * (ONE - OF_JOINTS * joint)


@inlined_kernel
def _joint(coordinate: np.float32, spacing: np.float32, pixel: np.float32) -> np.float32:
    """Return the share of a pixel that evenly spaced joints cover, 0-1; all lengths in m."""
    phase = coordinate * (ONE / spacing)
    aside = abs(phase - np.floor(phase + HALF)) * spacing
    soft = max(HALF * pixel, QUARTER * JOINT)
    share = min(ONE, max(NONE, (HALF * JOINT + soft - aside) / (TWO * soft)))
    return np.float32(share * sharpness32(spacing, pixel))


@kernel
def _add_spots(spots: NDArray[np.float32], count: int, even: int, scratch: TextureScratch) -> None:
    """Add spots of one size, unless no pixel shows them."""
    size, flatness, strength = spots[0], spots[1], spots[2]
    if not write_seen(size, strength, even, scratch.pixel, scratch.seen):
        return
    _place_in_noise(ONE / size, flatness / size, even, scratch)
    for column in range(count):
        scratch.corner[column] = FOURS[nonnegative(scratch.corner[column])]
        scratch.corner_above[column] = FOURS[nonnegative(scratch.corner_above[column])]
    _brighten(even, scratch)


@disjoint_kernel
def _brighten(even: int, scratch: TextureScratch) -> None:
    """Multiply brightnesses by those of spots, given the numbers of the noise around each place."""
    for column in range(even):
        east, north = scratch.east[column], scratch.north[column]
        below = between(scratch.corner[column], east, north)
        above = between(scratch.corner_above[column], east, north)
        bright = below + (above - below) * scratch.rise[column] - HALF
        scratch.grain[column] *= ONE + scratch.seen[column] * bright


@disjoint_kernel
def _place_in_noise(per_m: np.float32, per_m_up: np.float32, even: int, scratch: TextureScratch) -> None:
    """Write where places are in the noise, of which so much is in a metre; see ``noise.noise``.

    It lies between two levels, taken from distant parts of the plane.
    """
    for column in range(even):
        x, y, z = scratch.x[column] * per_m, scratch.y[column] * per_m_up, scratch.z[column] * per_m
        west, level, south = np.floor(x), np.floor(y), np.floor(z)
        scratch.east[column], scratch.north[column] = eased32(x - west), eased32(z - south)
        scratch.rise[column] = eased32(y - level)
        first, lower, row = int(np.int32(west)), int(np.int32(level)), int(np.int32(south))
        scratch.corner[column] = _corner(first, lower, row)
        scratch.corner_above[column] = _corner(first, lower + 1, row)


@inlined_kernel
def _corner(west: int, level: int, south: int) -> int:
    """Return ``corner_of`` a place at some level."""
    return corner_of(west + 57 * (level & 63), south + 113 * (level & 31))


@disjoint_kernel
def _write_shown(color: np.float32, grain: NDArray[np.float32], shown: NDArray[np.float32]) -> None:
    for column in range(shown.shape[0]):
        shown[column] = color * grain[column]
