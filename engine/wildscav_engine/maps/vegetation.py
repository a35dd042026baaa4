"""Trees and rocks: in woods and clearings, never in water, houses or doorways."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import polygon, rounded_polygon, stack
from wildscav_engine.geometry.world import CELL, Kind, Solid
from wildscav_engine.kernel import array_kernel, kernel
from wildscav_engine.maps.footprints import Site, footprints_of
from wildscav_engine.maps.terrain import Terrain, distance_to_footprint
from wildscav_engine.rng import Dice, Stream, uniform
from wildscav_engine.spec import MapConfig

STREAM = int(Stream.VEGETATION)
TREES, ROCKS = 0.0075, 0.003  # a m², with vegetation 1
EDGE_MARGIN = 2.0  # m from the edge of the map
HOUSE_MARGIN, DOORSTEP_MARGIN = 3.2, 3.6  # m between a plant's axis and a house or the place before a door
TREE_SPACING, ROCK_SPACING = 3.0, 4.5  # m between axes, so that one walks between
SHORE_MARGIN = 0.1  # m above the water
STEEPEST = 0.8  # m up per m
TRIES = 12  # places tried for each plant
WOODS = 36.0  # m, size of woods and clearings, about
CROWN_CLEARANCE = 2.4  # m between the ground and a crown
WIDEST_CROWN = 2.6  # m, radius
ROOT = 0.6  # m that plants reach into the ground
LOWEST_ROCK, LARGEST_ROCK = 0.5, 2.0  # m


def plant(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    sites: Sequence[Site] | NDArray[np.float64],
    doorsteps: NDArray[np.float64],
    lanes: NDArray[np.float64] | None = None,
) -> list[Solid]:
    """Return the solids of all trees and rocks.

    Args:
        config: Of the map.
        seed: Of the map.
        terrain: With levelled ground.
        sites: Of the houses.
        doorsteps: (D, 2) m, x and z before each outer doorway.
        lanes: (L, 4) m, see ``sites.Settlement``.

    Returns:
        Two solids a tree, one a rock.
    """
    footprints = sites if isinstance(sites, np.ndarray) else footprints_of(sites)
    area = float(config.size * config.size) * config.vegetation
    trees, rocks = int(TREES * area + 0.5), int(ROCKS * area + 0.5)
    places = _scatter(
        np.uint64(seed),
        terrain.corner,
        terrain.heights,
        terrain.water_level,
        footprints,
        doorsteps,
        trees,
        rocks,
    )
    dice = Dice(seed, Stream.VEGETATION, agent=1)
    solids: list[Solid] = []
    for x, ground, z, highest, is_rock in places.tolist():
        solids += _rock(dice, x, ground, z) if is_rock else _tree(dice, x, ground, z, highest)
    return solids


def _tree(dice: Dice, x: float, ground: float, z: float, highest: float) -> list[Solid]:
    """A tapering trunk in a faceted crown, broad or slender."""
    turn, thickness = dice.uniform(0.0, 60.0), dice.uniform(0.16, 0.34)
    outline = polygon(6, turn)
    slender = dice.uniform() < 0.4
    radius = dice.uniform(1.1, 1.6) if slender else dice.uniform(1.5, WIDEST_CROWN)
    height = radius * (dice.uniform(2.6, 3.6) if slender else dice.uniform(1.3, 1.8))
    bottom = highest + CROWN_CLEARANCE + dice.uniform(0.0, 0.8)
    trunk_top = bottom + 0.5 * height
    trunk = stack(
        Kind.TRUNK, x, z, outline, [(ground - ROOT, thickness * 1.25), (trunk_top, thickness * 0.7)]
    )
    rings = [
        (bottom, 0.55 * radius),
        (bottom + 0.3 * height, radius),
        (bottom + 0.75 * height, 0.65 * radius),
    ]
    rings = [(bottom, 0.8 * radius), (bottom + 0.18 * height, radius)] if slender else rings
    return [trunk, stack(Kind.CROWN, x, z, outline, [*rings, (bottom + height, 0.0)])]


def _rock(dice: Dice, x: float, ground: float, z: float) -> list[Solid]:
    """An irregular stump of a pyramid."""
    sides = dice.integer(5, 7)
    turn = dice.uniform(0.0, 360.0)
    step = 360.0 / sides
    yaws = [turn + corner * step + dice.uniform(-0.3, 0.3) * step for corner in range(sides)]
    outline = rounded_polygon(yaws, across=dice.uniform(0.7, 1.0))
    size = dice.uniform(LOWEST_ROCK, LARGEST_ROCK)
    height, radius = size * dice.uniform(0.6, 1.0), size * dice.uniform(0.5, 0.75)
    shoulder = dice.uniform(0.45, 0.65)
    rings = [
        (ground - ROOT, radius),
        (ground + shoulder * height, radius * 0.85),
        (ground + height, radius * dice.uniform(0.3, 0.5)),
    ]
    return [stack(Kind.ROCK, x, z, outline, rings)]


@array_kernel
def _scatter(
    seed: np.uint64,
    corner: tuple[float, float],
    heights: NDArray[np.float64],
    water_level: float,
    footprints: NDArray[np.float64],
    doorsteps: NDArray[np.float64],
    trees: int,
    rocks: int,
) -> NDArray[np.float64]:
    """Choose a place for each plant, by trial.

    Returns:
        (N, 5): x, height of the ground, z, height of the highest ground a crown could be over, all in m,
        and 1 for a rock. Plants without a place are left out.
    """
    count = trees + rocks
    places = np.empty((count, 5))
    found = 0
    half = -corner[0] - EDGE_MARGIN
    # Plants are linked by the 4 m cells they stand in, so that only near ones are compared.
    cells = int(-corner[0] / 2.0) + 1
    first = np.full((cells, cells), -1)
    following = np.full(count, -1)
    for number in range(count):
        is_rock = number >= trees
        for trial in range(TRIES):
            x = half * (2.0 * uniform(seed, STREAM, number + 1, trial, 0) - 1.0)
            z = half * (2.0 * uniform(seed, STREAM, number + 1, trial, 1) - 1.0)
            wooded = _woods(seed, x - corner[0], z - corner[1])
            if not is_rock and uniform(seed, STREAM, number + 1, trial, 2) > wooded:
                continue
            ground, highest = _ground(corner, heights, x, z, 0.0)
            if ground < water_level + SHORE_MARGIN or highest - ground > STEEPEST * CELL:
                continue
            if not _is_clear(footprints, doorsteps, x, z):
                continue
            row, column = int((z - corner[1]) / 4.0), int((x - corner[0]) / 4.0)
            spacing = ROCK_SPACING if is_rock else TREE_SPACING
            if _is_crowded(places, first, following, row, column, x, z, spacing):
                continue
            highest = _ground(corner, heights, x, z, WIDEST_CROWN)[1]
            places[found] = (x, ground, z, highest, 1.0 if is_rock else 0.0)
            following[found], first[row, column] = first[row, column], found
            found += 1
            break
    return places[:found]


@kernel
def _woods(seed: np.uint64, x: float, z: float) -> float:
    """Return how wooded a place is, 0.05 to 1: random values on a coarse grid, blended."""
    column, row = int(x / WOODS), int(z / WOODS)
    east, north = x / WOODS - column, z / WOODS - row
    east, north = east * east * (3.0 - 2.0 * east), north * north * (3.0 - 2.0 * north)
    south_value = (1.0 - east) * uniform(seed, STREAM, 0, row, column) + east * uniform(
        seed, STREAM, 0, row, column + 1
    )
    north_value = (1.0 - east) * uniform(seed, STREAM, 0, row + 1, column) + east * uniform(
        seed, STREAM, 0, row + 1, column + 1
    )
    share = (1.0 - north) * south_value + north * north_value
    return max(0.05, min(1.0, 3.0 * share - 0.9))


@kernel
def _ground(
    corner: tuple[float, float], heights: NDArray[np.float64], x: float, z: float, reach: float
) -> tuple[float, float]:
    """Return the least and the greatest height in m of the cells within reach of a place."""
    first_row = max(0, int((z - reach - corner[1]) / CELL))
    last_row = min(heights.shape[0] - 1, int((z + reach - corner[1]) / CELL) + 1)
    first_column = max(0, int((x - reach - corner[0]) / CELL))
    last_column = min(heights.shape[1] - 1, int((x + reach - corner[0]) / CELL) + 1)
    lowest, highest = np.inf, -np.inf
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            lowest, highest = min(lowest, heights[row, column]), max(highest, heights[row, column])
    return lowest, highest


@kernel
def _is_clear(footprints: NDArray[np.float64], doorsteps: NDArray[np.float64], x: float, z: float) -> bool:
    for house in range(footprints.shape[0]):
        if distance_to_footprint(footprints[house], x, z) < HOUSE_MARGIN:
            return False
    for door in range(doorsteps.shape[0]):
        east, north = x - doorsteps[door, 0], z - doorsteps[door, 1]
        if east * east + north * north < DOORSTEP_MARGIN * DOORSTEP_MARGIN:
            return False
    return True


@kernel
def _is_crowded(
    places: NDArray[np.float64],
    first: NDArray[np.int64],
    following: NDArray[np.int64],
    row: int,
    column: int,
    x: float,
    z: float,
    spacing: float,
) -> bool:
    """Return whether another plant is nearer than a spacing; looks at the 25 cells around."""
    for near_row in range(max(0, row - 2), min(first.shape[0], row + 3)):
        for near_column in range(max(0, column - 2), min(first.shape[1], column + 3)):
            other = first[near_row, near_column]
            while other >= 0:
                east, north = x - places[other, 0], z - places[other, 2]
                if east * east + north * north < spacing * spacing:
                    return True
                other = following[other]
    return False
