"""Footprints: the rectangles that houses and placements stand on, and the distances between them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.shapes import Pose, pose
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.ground.terrain import LEVEL_MARGIN, Terrain, distance_to_footprint, points_within
from wildscav_engine.specs.map_spec import MapConfig

WIDEST = {"block": 0.0, "tree": 0.5, "bush": 1.2, "rock": 2.2}  # m, greatest reach from the axis


class Site(NamedTuple):
    """The site of one house."""

    pose: Pose
    yaw: float  # degrees
    size: tuple[float, float]  # m, across and along
    ground: float  # m, height of the levelled ground

    @property
    def footprint(self) -> tuple[float, float, float, float, float, float]:
        """The footprint as a row for kernels: x, z, sine and cosine of the yaw, half of each size."""
        return (*self.pose, self.size[0] * 0.5, self.size[1] * 0.5)


def footprints_of(sites: Sequence[Site]) -> NDArray[np.float64]:
    """Return (H, 6) the footprints of sites."""
    return np.array([site.footprint for site in sites], np.float64).reshape(-1, 6)


def placed_footprints(config: MapConfig) -> NDArray[np.float64]:
    """Return (P, 6) the greatest possible footprints of a config's placements, except houses."""
    rows = [
        (*pose(*placed.location, placed.orientation), *(side * 0.5 + WIDEST[placed.kind] for side in area))
        for placed in config.placements
        if placed.kind != "house"
        for area in (placed.area or (0.0, 0.0),)
    ]
    return np.array(rows, np.float64).reshape(-1, 6)


@kernel
def corner_of(footprint: NDArray[np.float64], number: int) -> tuple[float, float]:
    """Return x and z of one of a footprint's four corners."""
    across = footprint[4] if number % 2 == 0 else -footprint[4]
    along = footprint[5] if number < 2 else -footprint[5]
    x = footprint[0] + across * footprint[3] + along * footprint[2]
    z = footprint[1] - across * footprint[2] + along * footprint[3]
    return x, z


@kernel
def farthest_out(footprint: NDArray[np.float64]) -> float:
    """Return the greatest distance in m of a footprint's corners from the map's middle, along x or z."""
    farthest = 0.0
    for number in range(4):
        x, z = corner_of(footprint, number)
        farthest = max(farthest, abs(x), abs(z))
    return farthest


@kernel
def gap_between(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the distance in m between two footprints, 0 where they overlap."""
    if not (_is_parted(one, other) or _is_parted(other, one)):
        return 0.0
    nearest = np.inf
    for number in range(4):
        x, z = corner_of(one, number)
        nearest = min(nearest, distance_to_footprint(other, x, z))
        x, z = corner_of(other, number)
        nearest = min(nearest, distance_to_footprint(one, x, z))
    return nearest


@kernel
def _is_parted(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Return whether all of the other footprint lies beyond one side of the first (separating axes)."""
    least_across, most_across, least_along, most_along = np.inf, -np.inf, np.inf, -np.inf
    for number in range(4):
        x, z = corner_of(other, number)
        east, north = x - one[0], z - one[1]
        across = east * one[3] - north * one[2]
        along = east * one[2] + north * one[3]
        least_across, most_across = min(least_across, across), max(most_across, across)
        least_along, most_along = min(least_along, along), max(most_along, along)
    return bool(
        least_across > one[4] or most_across < -one[4] or least_along > one[5] or most_along < -one[5]
    )


@kernel
def half_diagonal(footprint: NDArray[np.float64]) -> float:
    """Return the distance in m from the middle of a footprint to its corners."""
    return float(np.sqrt(footprint[4] * footprint[4] + footprint[5] * footprint[5]))


@kernel
def heights_under(terrain: Terrain, footprint: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the lowest, highest and mean height in m of the ground under a house and around it."""
    corner, heights = terrain.corner, terrain.heights
    reach = half_diagonal(footprint) + LEVEL_MARGIN
    first_row, last_row = points_within(corner[1], footprint[1], reach, heights.shape[0])
    first_column, last_column = points_within(corner[0], footprint[0], reach, heights.shape[1])
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
