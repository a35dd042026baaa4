"""The height field: natural relief, lakes in its hollows, level ground under houses."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.ground.erosion import add_finely, crumble, rain
from wildscav_engine.maps.ground.lakes import flood, largest_component, smooth_least, softened
from wildscav_engine.maps.ground.relief import (
    LEAST_RANGE,
    Noise,
    compose_land,
    draw_bumps,
    draw_landform,
    draw_noise,
    raise_cliffs,
)
from wildscav_engine.specs.body import TAN_SLOPE_LIMIT
from wildscav_engine.specs.map_spec import MapConfig

FLATTEST_SHAPE = 0.25  # the least relief with which land is shaped; flatter land is scaled down afterwards
# Rain carves valleys into coarse ground first, then gullies into the fine ground. Each pair: points of the
# height field per point of that ground, and drops per point of it.
VALLEY_RAINS, GULLY_RAIN = ((4, 0.45), (2, 0.2)), (1, 0.15)
ROUNDINGS = 2  # of smoothing per coarseness of the rained ground, whose squares are visible otherwise
LEAST_POINTS = 25  # along a side, the least ground to rain on
STEEPEST_SOIL = 0.62 * CELL  # m from one point to the next
CRUMBLING = 12  # rounds
# Share of the ground that can be walked from one place; rock is worn down until it is reached
LEAST_CONNECTED = 0.75
WEARING = 0.7  # factor of the rockiness each time
MAX_WEARING = 10  # times
LEVEL_MARGIN = 3.0  # m of level ground around a house: more than the diagonal of a cell
JOIN_SLOPE = 0.65  # m up per m, of the ground that joins level ground to a steeper slope
JOIN_START = 3.0  # m; the greater, the more gently the join starts
LONGEST_JOIN = 80.0  # m; beyond, the ground always keeps its natural height


class Terrain(NamedTuple):
    """The terrain before anything is built on it."""

    corner: tuple[float, float]  # m, x and z of the south-west corner
    heights: NDArray[np.float64]  # (R + 1, C + 1) m, at the cell corners
    water_level: float  # m, -inf without lakes


def make_terrain(config: MapConfig, seed: int) -> Terrain:
    """Return the terrain of a map; height 0 is the water level, or the lowest ground of a dry map."""
    corner = (-config.size / 2.0, -config.size / 2.0)
    cells = int(config.size // CELL)
    noise = draw_noise(seed)
    heights, cliffs = _shape_land(config, seed, noise, cells + 1)
    scale = config.relief / max(config.relief, FLATTEST_SHAPE)
    if config.water == 0.0:
        heights = (heights - heights.min()) * scale
        _connect_ground(cliffs, heights)
        return Terrain(corner, heights, -np.inf)
    bumps = np.empty(heights.shape)
    draw_bumps(max(config.relief, FLATTEST_SHAPE), noise, bumps)
    heights = flood(heights, bumps, config.water, scale)
    _connect_ground(cliffs, heights)
    return Terrain(corner, heights, 0.0)


def _shape_land(
    config: MapConfig, seed: int, noise: Noise, points: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (points, points) heights in m with cliffs and erosion, and how rocky the ground is."""
    key = np.uint64(seed)
    landform = draw_landform(config, max(config.relief, FLATTEST_SHAPE), seed)
    broad, hills, cliffs, heights = (np.empty((points, points)) for _ in range(4))
    compose_land(landform, noise, broad, hills, cliffs)
    broad *= max(1.0, LEAST_RANGE * landform.height / (broad.max() - broad.min()))
    for coarseness, drops in VALLEY_RAINS:
        _erode(key, coarseness, drops, broad)
    raise_cliffs(landform.step, softened(broad), cliffs, heights)
    heights += hills
    _erode(key, *GULLY_RAIN, heights)
    crumble(STEEPEST_SOIL, cliffs, CRUMBLING, heights)
    return heights, cliffs


def _connect_ground(cliffs: NDArray[np.float64], heights: NDArray[np.float64]) -> None:
    """Wear down rock, in place, until most of the ground can be walked from one place; keep lakes."""
    for _ in range(MAX_WEARING):
        if _connected_share(heights) >= LEAST_CONNECTED:
            break
        cliffs *= WEARING
        beds = heights.copy()
        crumble(STEEPEST_SOIL, cliffs, CRUMBLING, heights)
        # Screes end at the shore. Dry ground stays dry: soil slides only while it is higher above its
        # neighbour than any lake is deep.
        np.copyto(heights, beds, where=beds < 0.0)


def _connected_share(heights: NDArray[np.float64]) -> float:
    """Return the share of all cells in the largest connected component of cells that can be walked."""
    east, north = np.diff(heights, axis=1), np.diff(heights, axis=0)
    rise = np.maximum(
        east[:-1] * east[:-1] + north[:, 1:] * north[:, 1:],
        east[1:] * east[1:] + north[:, :-1] * north[:, :-1],
    )
    steepest = TAN_SLOPE_LIMIT * CELL
    cells = (rise < steepest * steepest).astype(np.int8)
    return largest_component(cells) / cells.size


def _erode(seed: np.uint64, coarseness: int, drops: float, heights: NDArray[np.float64]) -> None:
    """Let it rain on a coarser grid of points, and interpolate the change for those between."""
    ground = heights[::coarseness, ::coarseness].copy()
    if len(ground) < LEAST_POINTS:
        return
    change = -ground
    rain(seed, coarseness, int(drops * ground.size), ground)
    change += ground
    finely = np.zeros(heights.shape)
    add_finely(coarseness, softened(change), finely)
    for _ in range(ROUNDINGS * (coarseness - 1)):
        finely = softened(finely)
    heights += finely


def water_of_cells(heights: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Return (R, C) the height in m of the water over cells with ground below the level, -inf elsewhere."""
    south = np.minimum(heights[:-1, :-1], heights[:-1, 1:])
    north = np.minimum(heights[1:, :-1], heights[1:, 1:])
    return np.where(np.minimum(south, north) < level, level, -np.inf)


@kernel
def points_within(corner: float, coordinate: float, reach: float, count: int) -> tuple[int, int]:
    """Return the first and the last of ``count`` rows or columns of points that are in reach, all in m."""
    first = max(0, int((coordinate - reach - corner) / CELL))
    return first, min(count - 1, int((coordinate + reach - corner) / CELL) + 1)


@kernel
def distance_to_footprint(footprint: NDArray[np.float64], x: float, z: float) -> float:
    """Return the distance in m of (x, z) from a footprint (see ``footprints.Site``), 0 inside it."""
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
    """Make the ground level around each footprint and join it smoothly to its surroundings.

    The farther the ground is from a level area, the more it may differ from its height: it is cut and filled
    to these limits, and unchanged within them. So the join is as wide as the difference requires, and no
    steeper than its own slope and the natural one.

    Args:
        corner: m, x and z of the south-west corner.
        footprints: (H, 6), see ``footprints.Site``.
        grounds: (H,) m, the level around each.
        heights: (R + 1, C + 1) m, changed.
    """
    least, most = np.full(heights.shape, -np.inf), np.full(heights.shape, np.inf)
    for house in range(footprints.shape[0]):
        reach = footprints[house, 4] + footprints[house, 5] + LEVEL_MARGIN + LONGEST_JOIN
        first_row, last_row = points_within(corner[1], footprints[house, 1], reach, heights.shape[0])
        first_column, last_column = points_within(corner[0], footprints[house, 0], reach, heights.shape[1])
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                x, z = corner[0] + column * CELL, corner[1] + row * CELL
                away = max(0.0, distance_to_footprint(footprints[house], x, z) - LEVEL_MARGIN)
                if away < LONGEST_JOIN:
                    room = room_of_join(away)
                    least[row, column] = max(least[row, column], grounds[house] - room)
                    most[row, column] = min(most[row, column], grounds[house] + room)
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            if most[row, column] < np.inf:
                heights[row, column] = _within(heights[row, column], least[row, column], most[row, column])


@kernel
def room_of_join(away: float) -> float:
    """Return how much in m the ground may differ from the height of a level area ``away`` m from it.

    Two areas whose heights differ by no more than this at their distance both stay level.
    """
    if away >= LONGEST_JOIN:
        return np.inf
    away = max(0.0, away)
    share = (away / LONGEST_JOIN) * (away / LONGEST_JOIN)
    return JOIN_SLOPE * away * away / (away + JOIN_START) / (1.0 - share * share)


@kernel
def _within(height: float, least: float, most: float) -> float:
    """Return a height limited to a range; the middle of the limits where they contradict each other."""
    if least >= most:
        return 0.5 * (least + most)
    # Rounded off at both limits, but never so much that it leaves the range.
    width = min(1.0, 0.5 * (most - least))
    height = smooth_least(height, most, width)
    return -smooth_least(-height, -least, width)
