"""Where houses stand: dry, fairly level ground, clear of each other."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import Pose, pose
from wildscav_engine.geometry.world import CELL
from wildscav_engine.kernel import kernel
from wildscav_engine.maps.terrain import LEVEL_MARGIN, Terrain, distance_to_footprint
from wildscav_engine.rng import Dice, Stream
from wildscav_engine.spec import MapConfig

EDGE_MARGIN = 3.0  # m between a house and the edge of the map
SHORE_MARGIN = 0.25  # m that the natural ground under a house lies above the water
STEEPEST_GROUND = 4.5  # m, greatest difference of natural heights under a house
STEEPEST_JOIN = 0.3  # m up per m between the levels of two houses
TOWN_CHOICES = 12
SCATTERED_GAP, CLOSE_GAP = 9.0, 4.0  # m between houses
STREET_WIDTH, STREET_SPACING = 8.0, 40.0  # m
DARTS = 300  # places tried at random before all places are tried in order
ATTEMPTS = 6


class Site(NamedTuple):
    """Where one house stands."""

    pose: Pose
    yaw: float  # degrees
    size: tuple[float, float]  # m, across and along
    ground: float  # m, height of the levelled ground

    @property
    def footprint(self) -> tuple[float, float, float, float, float, float]:
        """The row that kernels take: x, z, sine and cosine of the yaw, half of each size."""
        return (*self.pose, self.size[0] * 0.5, self.size[1] * 0.5)


def footprints_of(sites: list[Site]) -> NDArray[np.float64]:
    """Return (H, 6) the footprints of sites."""
    return np.array([site.footprint for site in sites], np.float64).reshape(-1, 6)


def place_houses(
    config: MapConfig, seed: int, terrain: Terrain, sizes: list[tuple[float, float]]
) -> list[Site]:
    """Return a site for as many houses of the given sizes in m as have room."""
    best: list[Site] = []
    for attempt in range(ATTEMPTS):
        dice = Dice(seed, Stream.HOUSES, agent=attempt)
        if config.density == "high":
            sites = _along_streets(config, dice, terrain, sizes)
        else:
            sites = _scattered(config, dice, terrain, sizes, SCATTERED_GAP)
        sites += _scattered(config, dice, terrain, sizes[len(sites) :], CLOSE_GAP, sites)
        if len(sites) > len(best):
            best = sites
        if len(best) == len(sizes):
            break
    return best


def _scattered(
    config: MapConfig,
    dice: Dice,
    terrain: Terrain,
    sizes: list[tuple[float, float]],
    gap: float,
    standing: list[Site] | None = None,
) -> list[Site]:
    """Place houses anywhere; stop at the first that finds no room."""
    others = list(standing or [])
    already = len(others)
    for size in sizes:
        site = None
        for x, z, yaw in _places(config, dice):
            site = _site(terrain, x, z, yaw, size, others, gap)
            if site:
                others.append(site)
                break
        if not site:
            break
    return others[already:]


def _places(config: MapConfig, dice: Dice) -> Iterator[tuple[float, float, float]]:
    """Yield x, z and yaw of places at random, then of all places on a grid."""
    half = config.size / 2.0 - EDGE_MARGIN - 3.5
    for _ in range(DARTS):
        yield dice.uniform(-half, half), dice.uniform(-half, half), dice.uniform(-180.0, 180.0)
    steps = min(40, int(half))
    turn = dice.uniform(0.0, 90.0)
    for row in range(steps + 1):
        for column in range(steps + 1):
            for yaw in (0.0, turn):
                yield half * (2.0 * column / steps - 1.0), half * (2.0 * row / steps - 1.0), yaw


def _along_streets(
    config: MapConfig, dice: Dice, terrain: Terrain, sizes: list[tuple[float, float]]
) -> list[Site]:
    """Place houses on both sides of parallel streets, nearest to the middle first, fronts to the street."""
    town, yaw = _town(config, dice, terrain, len(sizes))
    reach = min(0.75 * config.size, 12.0 * len(sizes) + 20.0)
    most = min(len(sizes) // 8, int(0.75 * config.size / STREET_SPACING))
    slots = sorted(
        (max(abs(t * 2.0), abs(street) * 30.0), street, t, side)
        for street in range(-most, most + 1)
        for t in range(int(-reach / 2.0), int(reach / 2.0) + 1)
        for side in (-1, 1)
    )
    sites: list[Site] = []
    for _, street, t, side in slots:
        if len(sites) == len(sizes):
            break
        size = sizes[len(sites)]
        away = street * STREET_SPACING + side * (STREET_WIDTH / 2.0 + size[1] / 2.0 + dice.uniform(0.0, 1.0))
        x, z = town.outside(away, t * 2.0)
        facing = yaw - side * 90.0 + dice.uniform(-4.0, 4.0)
        site = _site(terrain, x, z, facing, size, sites, CLOSE_GAP)
        if site:
            sites.append(site)
    return sites


def _town(config: MapConfig, dice: Dice, terrain: Terrain, houses: int) -> tuple[Pose, float]:
    """Choose the middle and the yaw of the main street: of a few places, the most level one that is dry."""
    near, length = 0.25 * config.size, 4.0 * houses + 8.0
    best, best_score = (pose(0.0, 0.0, 0.0), 0.0), np.inf
    for _ in range(TOWN_CHOICES):
        yaw = dice.uniform(-180.0, 180.0)
        town = pose(dice.uniform(-near, near), dice.uniform(-near, near), yaw)
        ground = np.array((*town, 16.0, length))
        lowest, highest, _ = heights_under(terrain.corner, terrain.heights, ground)
        score = highest - lowest + (100.0 if lowest < terrain.water_level else 0.0)
        if score < best_score:
            best, best_score = (town, yaw), score
    return best


def _site(
    terrain: Terrain,
    x: float,
    z: float,
    yaw: float,
    size: tuple[float, float],
    others: list[Site],
    gap: float,
) -> Site | None:
    """Return the site at a place, or None if no house can stand there."""
    site = Site(pose(x, z, yaw), yaw, size, 0.0)
    ground = _ground_for(
        terrain.corner,
        terrain.heights,
        terrain.water_level,
        np.array(site.footprint),
        footprints_of(others),
        np.array([other.ground for other in others], np.float64),
        gap,
    )
    return site._replace(ground=ground) if ground > -np.inf else None


@kernel
def _ground_for(
    corner: tuple[float, float],
    heights: NDArray[np.float64],
    water_level: float,
    footprint: NDArray[np.float64],
    others: NDArray[np.float64],
    grounds: NDArray[np.float64],
    gap: float,
) -> float:
    """Return the level in m for a house with this footprint, or -inf if it cannot stand there."""
    if _reaches_edge(corner, footprint):
        return -np.inf
    for other in range(others.shape[0]):
        if gap_between(footprint, others[other]) < gap:
            return -np.inf
    lowest, highest, mean = heights_under(corner, heights, footprint)
    if lowest < water_level + SHORE_MARGIN or highest - lowest > STEEPEST_GROUND:
        return -np.inf
    ground = mean
    # Houses whose level margins meet share one level; a bit farther away, levels may differ a bit.
    for other in range(others.shape[0]):
        if gap_between(footprint, others[other]) < 2.0 * LEVEL_MARGIN + 0.5:
            ground = grounds[other]
    if abs(ground - mean) > 1.2:
        return -np.inf
    for other in range(others.shape[0]):
        apart = gap_between(footprint, others[other]) - 2.0 * LEVEL_MARGIN
        if abs(ground - grounds[other]) > STEEPEST_JOIN * max(0.0, apart):
            return -np.inf
    return ground


@kernel
def corner_of(footprint: NDArray[np.float64], number: int) -> tuple[float, float]:
    """Return x and z of one of a footprint's four corners."""
    across = footprint[4] if number % 2 == 0 else -footprint[4]
    along = footprint[5] if number < 2 else -footprint[5]
    x = footprint[0] + across * footprint[3] + along * footprint[2]
    z = footprint[1] - across * footprint[2] + along * footprint[3]
    return x, z


@kernel
def _reaches_edge(corner: tuple[float, float], footprint: NDArray[np.float64]) -> bool:
    for number in range(4):
        x, z = corner_of(footprint, number)
        if max(abs(x), abs(z)) > -corner[0] - EDGE_MARGIN:
            return True
    return False


@kernel
def gap_between(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the distance in m between two footprints; where two like ours cross, less than 4 m."""
    nearest = min(
        distance_to_footprint(one, other[0], other[1]), distance_to_footprint(other, one[0], one[1])
    )
    for number in range(4):
        x, z = corner_of(one, number)
        nearest = min(nearest, distance_to_footprint(other, x, z))
        x, z = corner_of(other, number)
        nearest = min(nearest, distance_to_footprint(one, x, z))
    return nearest


@kernel
def heights_under(
    corner: tuple[float, float], heights: NDArray[np.float64], footprint: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return the lowest, highest and mean height in m of the ground under a house and around it."""
    reach = footprint[4] + footprint[5] + LEVEL_MARGIN
    first_row = max(0, int((footprint[1] - reach - corner[1]) / CELL))
    first_column = max(0, int((footprint[0] - reach - corner[0]) / CELL))
    last_row = min(heights.shape[0] - 1, int((footprint[1] + reach - corner[1]) / CELL) + 1)
    last_column = min(heights.shape[1] - 1, int((footprint[0] + reach - corner[0]) / CELL) + 1)
    lowest, highest, total, count = np.inf, -np.inf, 0.0, 0
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            x, z = corner[0] + column * CELL, corner[1] + row * CELL
            if distance_to_footprint(footprint, x, z) <= LEVEL_MARGIN:
                lowest = min(lowest, heights[row, column])
                highest = max(highest, heights[row, column])
                total += heights[row, column]
                count += 1
    return lowest, highest, total / max(1, count)
