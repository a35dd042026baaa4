"""The height field: hills from gradient noise, lakes in their hollows, level ground under houses."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL
from wildscav_engine.kernel import array_kernel, kernel
from wildscav_engine.rng import Dice, Stream, uniform_in
from wildscav_engine.spec import MapConfig

STREAM = int(Stream.TERRAIN)
LARGEST_HILLS, SMALLEST_HILLS = 180.0, 9.0  # m, longest and shortest wave of the noise
ROUGHNESS = 0.42  # height of each octave of the noise by that of the one before
STEEPNESS = 0.055  # difference between highest and lowest ground by the size of the map
GREATEST_RELIEF = 45.0  # m
DEEPEST_WATER = 1.2  # m; agents wade, and their eyes stay above the surface
SHORE = 0.7  # m; the smaller, the sooner a lake reaches its depth
LEVEL_MARGIN = 3.0  # m of level ground around a house: more than the diagonal of a cell
JOIN = 8.0  # m over which level ground joins the slope around it


class Terrain(NamedTuple):
    """The ground before anything stands on it."""

    corner: tuple[float, float]  # m, x and z of the south-west corner
    heights: NDArray[np.float64]  # (R + 1, C + 1) m, at the cell corners
    water_level: float  # m, -inf without lakes


def make_terrain(config: MapConfig, seed: int) -> Terrain:
    """Return the hills and lakes of a map, around height 0."""
    cells = int(config.size // CELL)
    heights = np.zeros((cells + 1, cells + 1))
    wave, height, octave = min(0.7 * config.size, LARGEST_HILLS), 1.0, 0
    while wave >= SMALLEST_HILLS:
        _add_noise(np.uint64(seed), octave, wave / CELL, height, heights)
        wave, height, octave = wave * 0.5, height * ROUGHNESS, octave + 1
    lowest, highest = heights.min(), heights.max()
    share = (heights - lowest) / (highest - lowest)
    share = share * (0.65 + 0.35 * share)  # broader valleys, narrower tops
    dice = Dice(seed, Stream.TERRAIN, agent=1)
    relief = min(GREATEST_RELIEF, STEEPNESS * config.size) * dice.uniform(0.8, 1.15)
    heights, level = _flood(share * relief, config.water)
    half = config.size / 2.0
    return Terrain((-half, -half), heights, level)


@array_kernel
def _add_noise(
    seed: np.uint64, octave: int, wave: float, height: float, heights: NDArray[np.float64]
) -> None:
    """Add one octave of gradient noise (Perlin, "Improving Noise", SIGGRAPH 2002).

    Args:
        seed: Of the map.
        octave: Its number, which keys its random numbers.
        wave: Distance between the noise's own grid points, in cells of the map.
        height: m, factor of the noise.
        heights: (R, C) m, added to.
    """
    points = int(heights.shape[0] / wave) + 3
    slopes = np.empty((points, points, 2))
    for row in range(points):
        for column in range(points):
            for axis in range(2):
                draw = 2 * column + axis
                slopes[row, column, axis] = uniform_in(-1.0, 1.0, seed, STREAM, octave + 1, row, draw)
    shift_z = uniform_in(0.0, 1.0, seed, STREAM, octave + 1, points, 0)
    shift_x = uniform_in(0.0, 1.0, seed, STREAM, octave + 1, points, 1)
    for row in range(heights.shape[0]):
        z = row / wave + shift_z
        south = int(z)
        for column in range(heights.shape[1]):
            x = column / wave + shift_x
            west = int(x)
            heights[row, column] += height * _noise(slopes, south, west, z - south, x - west)


@kernel
def _noise(slopes: NDArray[np.float64], south: int, west: int, north: float, east: float) -> float:
    """Blend the planes of the four grid points around a point that lies (north, east) of the first."""
    blend_z = north * north * north * (north * (north * 6.0 - 15.0) + 10.0)
    blend_x = east * east * east * (east * (east * 6.0 - 15.0) + 10.0)
    total = 0.0
    for row in range(2):
        weight_z = blend_z if row == 1 else 1.0 - blend_z
        for column in range(2):
            weight_x = blend_x if column == 1 else 1.0 - blend_x
            slope = slopes[south + row, west + column]
            plane = slope[0] * (north - row) + slope[1] * (east - column)
            total += weight_z * weight_x * plane
    return total


def _flood(heights: NDArray[np.float64], water: float) -> tuple[NDArray[np.float64], float]:
    """Let water stand in the lowest places, and make the beds shallow; height 0 is the water's level."""
    ascending = np.sort(heights, axis=None, kind="stable")
    level = ascending[int(water * (ascending.size - 1))]
    heights = heights - level
    if water == 0.0:
        return heights, -np.inf
    depth = np.maximum(0.0, -heights)
    return np.where(heights < 0.0, -DEEPEST_WATER * depth / (depth + SHORE), heights), 0.0


def water_of_cells(heights: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Return (R, C) the height in m of the surface over each cell with ground below it, -inf elsewhere."""
    south = np.minimum(heights[:-1, :-1], heights[:-1, 1:])
    north = np.minimum(heights[1:, :-1], heights[1:, 1:])
    return np.where(np.minimum(south, north) < level, level, -np.inf)


@kernel
def distance_to_footprint(footprint: NDArray[np.float64], x: float, z: float) -> float:
    """Return how far in m (x, z) is from a footprint (see ``sites.Site``), 0 inside it."""
    east, north = x - footprint[0], z - footprint[1]
    across = abs(east * footprint[3] - north * footprint[2]) - footprint[4]
    along = abs(east * footprint[2] + north * footprint[3]) - footprint[5]
    across, along = max(0.0, across), max(0.0, along)
    return float(np.sqrt(across * across + along * along))


@array_kernel
def level_ground(
    corner: tuple[float, float],
    footprints: NDArray[np.float64],
    grounds: NDArray[np.float64],
    heights: NDArray[np.float64],
) -> None:
    """Make the ground level around each footprint and join it smoothly to what is around.

    Between two footprints the ground is a mean of both levels and of the natural height, weighted by how
    near they are (Shepard's method, each weight growing without bound towards its footprint).

    Args:
        corner: m, x and z of the south-west corner.
        footprints: (H, 6), see ``sites.Site``.
        grounds: (H,) m, the level around each.
        heights: (R + 1, C + 1) m, changed.
    """
    weights = np.ones(heights.shape)
    for house in range(footprints.shape[0]):
        reach = footprints[house, 4] + footprints[house, 5] + LEVEL_MARGIN + JOIN
        first_row = max(0, int((footprints[house, 1] - reach - corner[1]) / CELL))
        first_column = max(0, int((footprints[house, 0] - reach - corner[0]) / CELL))
        last_row = min(heights.shape[0] - 1, int((footprints[house, 1] + reach - corner[1]) / CELL) + 1)
        last_column = min(heights.shape[1] - 1, int((footprints[house, 0] + reach - corner[0]) / CELL) + 1)
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                x, z = corner[0] + column * CELL, corner[1] + row * CELL
                away = (distance_to_footprint(footprints[house], x, z) - LEVEL_MARGIN) / JOIN
                if away <= 0.0:
                    heights[row, column], weights[row, column] = grounds[house], np.inf
                elif away < 1.0 and weights[row, column] < np.inf:
                    blend = away * away * (3.0 - 2.0 * away)
                    weight = 1.0 / blend - 1.0
                    before = weights[row, column]
                    both = before + weight
                    heights[row, column] = (heights[row, column] * before + grounds[house] * weight) / both
                    weights[row, column] = both
