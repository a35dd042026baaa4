"""The appearance of the ground: a colour and a smooth normal at each corner of the cells."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World, cell_of
from wildscav_engine.rendering.palette import of_terrain
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dimmed
from wildscav_engine.rendering.shading.noise import noise
from wildscav_engine.rendering.shading.surfaces import sharpness

SHORE = 3  # cells around water that show sand


class GroundAppearance(NamedTuple):
    """The appearance of R by C cells of ground, at their corners."""

    color: NDArray[np.float32]  # (R + 1, C + 1, 3) red, green, blue 0-255, unlit
    normal: NDArray[np.float32]  # (R + 1, C + 1, 3) unit vectors


def ground_appearance(world: World) -> GroundAppearance:
    """Return the appearance of a world's ground."""
    slope_north, slope_east = np.gradient(world.heights, CELL)
    up = 1.0 / np.sqrt(1.0 + slope_east * slope_east + slope_north * slope_north)
    normal = np.stack([-slope_east * up, up, -slope_north * up], axis=-1)
    dryness = np.empty(world.heights.shape)
    _write_dryness(dryness)
    over_water = world.heights - _water_nearby(world)
    color = of_terrain(over_water.ravel(), up.ravel(), dryness.ravel())
    return GroundAppearance(color.reshape(normal.shape).astype(np.float32), normal.astype(np.float32))


def _water_nearby(world: World) -> NDArray[np.float64]:
    """Return the height of the water near each cell corner, (R + 1, C + 1), -inf where there is none."""
    nearby = np.full(world.heights.shape, -np.inf)
    rows, columns = world.water.shape
    for row in range(2):
        for column in range(2):
            part = nearby[row : row + rows, column : column + columns]
            np.maximum(part, world.water, out=part)
    for _ in range(SHORE):
        nearby[1:] = np.maximum(nearby[1:], nearby[:-1])
        nearby[:-1] = np.maximum(nearby[:-1], nearby[1:])
        nearby[:, 1:] = np.maximum(nearby[:, 1:], nearby[:, :-1])
        nearby[:, :-1] = np.maximum(nearby[:, :-1], nearby[:, 1:])
    return nearby


@kernel
def _write_dryness(dryness: NDArray[np.float64]) -> None:
    """Write the dryness of each cell corner, 0-1: soft patches with a little grain."""
    for row in range(dryness.shape[0]):
        for column in range(dryness.shape[1]):
            wide = noise(column / 23.0, row / 23.0) + 0.6 * noise(column / 9.0 + 40.0, row / 9.0)
            fine = noise(column + 0.5, row + 80.5) - 0.5
            dryness[row, column] = min(1.0, max(0.0, 1.7 * (wide / 1.6 - 0.5) + 0.42 + 0.3 * fine))


@inlined_kernel
def ground_color(world: World, appearance: GroundAppearance, place: Vector, pixel: float) -> Color:
    """Return the colour of the ground at a place, with its grain; ``pixel`` is a pixel's size there in m."""
    x, _, z = place
    row, column, north, east = _in_cell(world, x, z)
    color = (
        _between(appearance.color, row, column, north, east, 0),
        _between(appearance.color, row, column, north, east, 1),
        _between(appearance.color, row, column, north, east, 2),
    )
    grain = 1.0
    for size, strength in ((0.11, 0.34), (0.45, 0.26), (2.3, 0.20)):
        seen = strength * sharpness(size, pixel)
        if seen > 0.0:
            grain += seen * (noise(x / size, z / size) - 0.5)
    return dimmed(color, grain)


@inlined_kernel
def ground_normal(world: World, appearance: GroundAppearance, place: Vector) -> Vector:
    """Return the unit normal of the ground at a place, smooth across the edges of its triangles."""
    row, column, north, east = _in_cell(world, place[0], place[2])
    x = _between(appearance.normal, row, column, north, east, 0)
    y = _between(appearance.normal, row, column, north, east, 1)
    z = _between(appearance.normal, row, column, north, east, 2)
    length = np.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


@inlined_kernel
def _in_cell(world: World, x: float, z: float) -> tuple[int, int, float, float]:
    """Return the row and column of a place's cell, and its position in it northwards and eastwards, 0-1."""
    rows, columns = world.water.shape
    row, column = cell_of(world.corner[1], z, rows), cell_of(world.corner[0], x, columns)
    north = (z - world.corner[1]) / CELL - row
    east = (x - world.corner[0]) / CELL - column
    return row, column, clipped(north, 0.0, 1.0), clipped(east, 0.0, 1.0)


@inlined_kernel
def _between(
    corners: NDArray[np.float32], row: int, column: int, north: float, east: float, channel: int
) -> float:
    """Return the bilinear interpolation of the values at the four corners of a cell."""
    south_west, south_east = corners[row, column, channel], corners[row, column + 1, channel]
    north_west, north_east = corners[row + 1, column, channel], corners[row + 1, column + 1, channel]
    south = south_west + (south_east - south_west) * east
    top = north_west + (north_east - north_west) * east
    return float(south + (top - south) * north)
