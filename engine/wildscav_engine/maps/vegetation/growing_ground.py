"""The ground for plants: where they grow and what they must stay away from.

Woods, meadows, stony slopes and shores come from low-frequency noise and the terrain.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Stream, uniform
from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.footprints import corner_of

STREAM = int(Stream.VEGETATION)
PATCH = 4.0  # m, side of the squares that are wooded or not
LARGEST_WOODS, SMALLEST_WOODS = 80.0, 18.0  # m, approximate size of woods and clearings
LEAST_WOODED, MAX_WOODED = 0.08, 0.42  # share of the map under woods, with minimal and full vegetation
EDGE = 0.05  # range of the noise over which a wood thins out
SHORE_REACH = 2  # patches from the water that are shore
TREES, BUSHES, ROCKS = range(3)  # categories of plants
Point = tuple[float, float]  # m, x and z
NEAR = 10.0  # m; houses, doorsteps and lanes farther away need no test


def wooded(seed: int, size: int, vegetation: float) -> NDArray[np.float64]:
    """Return the density of woods on each patch, 0 to 1: distinct woods with narrow edges."""
    noise = slow_noise(seed, size, 0)
    ascending = np.sort(noise, axis=None, kind="stable")
    share = LEAST_WOODED + (MAX_WOODED - LEAST_WOODED) * vegetation
    threshold = ascending[min(ascending.size - 1, int((1.0 - share) * ascending.size))]
    inside: NDArray[np.float64] = np.clip((noise - threshold) / EDGE + 0.5, 0.0, 1.0)
    return inside * inside * (3.0 - 2.0 * inside)


def slow_noise(seed: int, size: int, layer: int) -> NDArray[np.float64]:
    """Return (P, P) noise from 0 to 1 that changes slowly from patch to patch."""
    patches = int(size / PATCH) + 1
    wave = max(SMALLEST_WOODS, min(LARGEST_WOODS, size / 4.0)) / PATCH
    noise = np.zeros((patches, patches))
    _add_noise(np.uint64(seed), 2 * layer, wave, 0.7, noise)
    _add_noise(np.uint64(seed), 2 * layer + 1, wave * 0.37, 0.3, noise)
    return noise


@array_kernel
def _add_noise(seed: np.uint64, layer: int, wave: float, weight: float, noise: NDArray[np.float64]) -> None:
    """Add value noise with a wavelength of ``wave`` patches."""
    patches = noise.shape[0]
    points = int(1.4 * patches / wave) + 3
    values = np.empty((points, points))
    for row in range(points):
        for column in range(points):
            values[row, column] = uniform(seed, STREAM, 0, layer * 4096 + row, column)
    shift_x = uniform(seed, STREAM, 0, layer * 4096 + points, 0)
    shift_z = uniform(seed, STREAM, 0, layer * 4096 + points, 1)
    for row in range(patches):
        for column in range(patches):
            # The grid is rotated, so that edges of woods do not align with the map's.
            x = (0.8 * column + 0.6 * row) / wave + shift_x
            z = (0.8 * row + 0.6 * (patches - 1 - column)) / wave + shift_z
            west, south = int(x), int(z)
            east, north = x - west, z - south
            east, north = east * east * (3.0 - 2.0 * east), north * north * (3.0 - 2.0 * north)
            lower = values[south, west] * (1.0 - east) + values[south, west + 1] * east
            upper = values[south + 1, west] * (1.0 - east) + values[south + 1, west + 1] * east
            noise[row, column] += weight * (lower * (1.0 - north) + upper * north)


@array_kernel
def shores(terrain: Terrain, patches: int) -> NDArray[np.bool_]:
    """Return (P, P) which patches lie at a lake."""
    shore, heights, step = np.zeros((patches, patches), np.bool_), terrain.heights, int(PATCH / CELL)
    for row in range(heights.shape[0] // step):
        for column in range(heights.shape[1] // step):
            if heights[row * step, column * step] >= terrain.water_level:
                continue
            for near_row in range(max(0, row - SHORE_REACH), min(shore.shape[0], row + SHORE_REACH + 1)):
                for near in range(
                    max(0, column - SHORE_REACH), min(shore.shape[1], column + SHORE_REACH + 1)
                ):
                    shore[near_row, near] = True
    return shore


@array_kernel
def steepness(terrain: Terrain, patches: int) -> NDArray[np.float64]:
    """Return (P, P) m up per m, the steepest ground within about 6 m of each patch."""
    steep, heights, step = np.zeros((patches, patches)), terrain.heights, int(PATCH / CELL)
    for row in range(steep.shape[0]):
        for column in range(steep.shape[1]):
            steepest = 0.0
            for south in range(max(0, (row - 1) * step), min(heights.shape[0] - 1, (row + 2) * step)):
                for west in range(
                    max(0, (column - 1) * step), min(heights.shape[1] - 1, (column + 2) * step)
                ):
                    east = heights[south, west + 1] - heights[south, west]
                    north = heights[south + 1, west] - heights[south, west]
                    steepest = max(steepest, east * east + north * north)
            steep[row, column] = np.sqrt(steepest) / CELL
    return steep


class Fields(NamedTuple):
    """What grows where, on a grid of Q by Q patches of 4 m."""

    weights: NDArray[np.float64]  # (3, Q, Q) chance that a tree, bush or rock is accepted on a patch
    conifers: NDArray[np.float64]  # (Q, Q) chance that a tree in a wood is a conifer
    shore: NDArray[np.bool_]  # (Q, Q)


class GrowingGround(NamedTuple):
    """The ground for plants: where they grow and what they must stay away from."""

    terrain: Terrain
    houses: NDArray[np.float64]  # (H, 6) footprints
    placed: NDArray[np.float64]  # (P, 6) footprints of placements
    doorsteps: NDArray[np.float64]  # (D, 2) m
    lanes: NDArray[np.float64]  # (L, 4) m
    near: NDArray[np.bool_]  # (Q, Q) patches near any of these
    fields: Fields


def land_of(
    terrain: Terrain,
    houses: NDArray[np.float64],
    placed: NDArray[np.float64],
    doorsteps: NDArray[np.float64],
    lanes: NDArray[np.float64],
    fields: Fields,
) -> GrowingGround:
    """Return the growing ground, with the patches near obstacles marked."""
    near = np.zeros(fields.shore.shape, np.bool_)
    _mark_near(terrain.corner, houses, near)
    _mark_near(terrain.corner, placed, near)
    _mark_near_lanes(terrain.corner, np.hstack([doorsteps, doorsteps]), near)
    _mark_near_lanes(terrain.corner, lanes, near)
    return GrowingGround(terrain, houses, placed, doorsteps, lanes, near, fields)


@kernel
def _mark_near(corner: Point, footprints: NDArray[np.float64], near: NDArray[np.bool_]) -> None:
    for number in range(footprints.shape[0]):
        footprint = footprints[number]
        low_x, high_x, low_z, high_z = np.inf, -np.inf, np.inf, -np.inf
        for end in range(4):
            x, z = corner_of(footprint, end)
            low_x, high_x, low_z, high_z = min(low_x, x), max(high_x, x), min(low_z, z), max(high_z, z)
        _mark_box(corner, low_x, low_z, high_x, high_z, near)


@kernel
def _mark_near_lanes(corner: Point, lanes: NDArray[np.float64], near: NDArray[np.bool_]) -> None:
    for number in range(lanes.shape[0]):
        x0, z0, x1, z1 = lanes[number, 0], lanes[number, 1], lanes[number, 2], lanes[number, 3]
        _mark_box(corner, min(x0, x1), min(z0, z1), max(x0, x1), max(z0, z1), near)


@kernel
def _mark_box(
    corner: Point, low_x: float, low_z: float, high_x: float, high_z: float, near: NDArray[np.bool_]
) -> None:
    count = near.shape[0]
    first_row, last_row = _patch(corner[1], low_z - NEAR, count), _patch(corner[1], high_z + NEAR, count)
    first, last = _patch(corner[0], low_x - NEAR, count), _patch(corner[0], high_x + NEAR, count)
    for row in range(first_row, last_row + 1):
        for column in range(first, last + 1):
            near[row, column] = True


@kernel
def patch_of(land: GrowingGround, x: float, z: float) -> tuple[int, int]:
    """Return the row and column of a place's patch; outside the map, of the nearest one."""
    count = land.near.shape[0]
    return _patch(land.terrain.corner[1], z, count), _patch(land.terrain.corner[0], x, count)


@kernel
def _patch(corner: float, coordinate: float, count: int) -> int:
    return min(count - 1, max(0, int((coordinate - corner) / PATCH)))
