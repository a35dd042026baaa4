"""Procedural textures of floors, stairs and roofs: boards and tiles.

Details finer than a pixel fade out, so that they do not flicker.
"""

import math

import numpy as np

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dimmed, mixed
from wildscav_engine.rendering.shading.noise import grain, noise

FLOOR, STAIR, ROOF = int(Kind.FLOOR), int(Kind.STAIR), int(Kind.ROOF)
CEILING = (226.0, 222.0, 212.0)
# How visible details are: SHARPEST less BLUR times the size of a pixel, in sizes of the details.
SHARPEST, BLUR = 1.6, 2.4
LEVEL = 0.9  # least upward part of the normal of a face that can be walked on


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
            return mixed(color, CEILING, 0.8)
        return _boarded(color, across, along, 0.18, pixel) if normal[1] > 0.5 else dimmed(color, 0.8)
    if kind == STAIR:
        return _boarded(color, along, across, 0.3, pixel) if normal[1] > 0.5 else dimmed(color, 0.68)
    if kind == ROOF:
        return _tiled(color, normal, place, pixel)
    return color


# Where a size is constant, so are these quotients: the compiler then replaces divisions, which are slow.


@inlined_kernel
def sharpness(size: float, pixel: float) -> float:
    """Return how visible a detail of some size in m is, 0-1, at a pixel size in m."""
    return clipped(SHARPEST - pixel * (BLUR / size), 0.0, 1.0)


@inlined_kernel
def _line(coordinate: float, spacing: float, width: float, pixel: float) -> float:
    """Return the share of a pixel that evenly spaced lines cover, 0-1; all lengths in m."""
    phase = coordinate * (1.0 / spacing)
    aside = abs(phase - math.floor(phase + 0.5)) * spacing
    soft = max(0.5 * pixel, 0.25 * width)
    return clipped((0.5 * width + soft - aside) / (2.0 * soft), 0.0, 1.0) * sharpness(spacing, pixel)


@inlined_kernel
def _boarded(color: Color, across: float, along: float, width: float, pixel: float) -> Color:
    """Return the colour of boards side by side, each of its own brightness, with dark joints."""
    board = math.floor(across * (1.0 / width))
    length = math.floor(along * (1.0 / 2.6) + grain(board, 7, 3))
    own = 1.0 + 0.18 * (grain(board, length, 11) - 0.5) * sharpness(width, pixel)
    joint = _line(across, width, 0.014, pixel)
    fibre = 0.10 * (noise(across * (1.0 / 0.03), along * 2.0) - 0.5) * sharpness(0.05, pixel)
    return dimmed(color, (own + fibre) * (1.0 - 0.40 * joint))


@inlined_kernel
def _tiled(color: Color, normal: Vector, place: Vector, pixel: float) -> Color:
    """Return the colour of rows of tiles, dark at their lower edges; plain under eaves."""
    if normal[1] < 0.05:
        return dimmed(color, 0.62)
    level = np.sqrt(normal[0] * normal[0] + normal[2] * normal[2])
    # The distances up the slope and along the eaves.
    up, along = place[1] / level, (normal[2] * place[0] - normal[0] * place[2]) / level
    row = math.floor(up / 0.34)
    along += 0.14 * (row & 1)
    column = math.floor(along / 0.28)
    seen = sharpness(0.34, pixel)
    own = 1.0 + seen * (0.22 * (grain(row, column, 2) - 0.5) + 0.16 * (up / 0.34 - row - 0.5))
    joint = max(_line(up, 0.34, 0.03, pixel), 0.6 * _line(along, 0.28, 0.02, pixel))
    return dimmed(color, own * (1.0 - 0.38 * joint))
