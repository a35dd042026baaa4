"""The appearance of the ground: a colour and a smooth normal at each corner of the cells."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World, cell_of
from wildscav_engine.rendering.palette import of_terrain
from wildscav_engine.rendering.shading.color_arithmetic import Color, Vector, clipped, dimmed
from wildscav_engine.rendering.shading.noise import endless_noise, noise
from wildscav_engine.rendering.shading.surfaces import sharpness

ONE = np.float32(1.0)
SHORE = 3  # cells around water that show sand
# The grain of the ground: sizes in m of its details, and between the darkest and the brightest of them.
FINE, MEDIUM, COARSE = (0.11, 0.34), (0.45, 0.26), (2.3, 0.20)


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
            wide = endless_noise(column / 23.0, row / 23.0) + 0.6 * endless_noise(
                column / 9.0 + 40.0, row / 9.0
            )
            fine = endless_noise(column + 0.5, row + 80.5) - 0.5
            dryness[row, column] = min(1.0, max(0.0, 1.7 * (wide / 1.6 - 0.5) + 0.42 + 0.3 * fine))


def packed_ground(appearance: GroundAppearance) -> NDArray[np.float32]:
    """Return (R + 1, C + 1, 8) for kernels: of each corner its colour, its normal and two zeros.

    What belongs to a corner lies together in memory, because a pixel reads all of it.
    """
    packed = np.zeros((*appearance.color.shape[:2], 8), np.float32)
    packed[..., :3], packed[..., 3:6] = appearance.color, appearance.normal
    return packed


class GroundCell(NamedTuple):
    """Where a place is on the ground."""

    row: int  # of its cell
    column: int
    north: float  # position in the cell, 0-1
    east: float


@inlined_kernel
def cell_at(world: World, x: float, z: float) -> GroundCell:
    """Return the cell of a place and its position in it."""
    rows, columns = world.water.shape
    row, column = cell_of(world.corner[1], z, rows), cell_of(world.corner[0], x, columns)
    north = (z - world.corner[1]) / CELL - row
    east = (x - world.corner[0]) / CELL - column
    return GroundCell(row, column, clipped(north, 0.0, 1.0), clipped(east, 0.0, 1.0))


@inlined_kernel
def ground_color(ground: NDArray[np.float32], cell: GroundCell, place: Vector, pixel: float) -> Color:
    """Return the colour of the ground at a place, with its grain.

    Args:
        place: m.
        pixel: m, the size of a pixel there.
    """
    grain = _grain(place, FINE, pixel) + _grain(place, MEDIUM, pixel) + _grain(place, COARSE, pixel)
    corners = corners_of(ground, cell.row, cell.column, np.float32(cell.north), np.float32(cell.east))
    base = (float(blend(corners, 0)), float(blend(corners, 1)), float(blend(corners, 2)))
    return dimmed(base, 1.0 + grain)


@inlined_kernel
def _grain(place: Vector, details: tuple[float, float], pixel: float) -> float:
    """Return how much brighter the ground is for details of one size."""
    size, strength = details
    seen = strength * sharpness(size, pixel)
    if seen == 0.0:
        return 0.0
    return seen * (noise(place[0] * (1.0 / size), place[2] * (1.0 / size)) - 0.5)


class Corners(NamedTuple):
    """What the corners of a cell have, as in ``packed_ground``, and how much each of them counts."""

    south_west: NDArray[np.float32]  # (8,)
    south_east: NDArray[np.float32]
    north_west: NDArray[np.float32]
    north_east: NDArray[np.float32]
    share_south_west: np.float32
    share_south_east: np.float32
    share_north_west: np.float32
    share_north_east: np.float32


@inlined_kernel
def corners_of(
    ground: NDArray[np.float32], row: int, column: int, north: np.float32, east: np.float32
) -> Corners:
    """Return the corners of a cell for a bilinear interpolation at a position in it."""
    both = north * east
    return Corners(
        ground[row, column],
        ground[row, column + 1],
        ground[row + 1, column],
        ground[row + 1, column + 1],
        ONE - north - (east - both),
        east - both,
        north - both,
        both,
    )


@inlined_kernel
def blend(corners: Corners, part: int) -> np.float32:
    """Return the interpolation of one of the numbers that the corners have."""
    return np.float32(
        corners.share_south_west * corners.south_west[part]
        + corners.share_south_east * corners.south_east[part]
        + corners.share_north_west * corners.north_west[part]
        + corners.share_north_east * corners.north_east[part]
    )
