"""The ground for plants: where they grow and what they must stay away from."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.footprints import corner_of
from wildscav_engine.maps.vegetation.woods import PATCH

TREES, BUSHES, ROCKS = range(3)  # categories of plants
NEAR = 10.0  # m; houses, doorsteps and lanes farther away need no test


class Fields(NamedTuple):
    """What grows where, on a grid of Q by Q patches of 4 m."""

    weights: NDArray[np.float64]  # (3, Q, Q) chance that a tree, bush or rock is accepted on a patch
    conifers: NDArray[np.float64]  # (Q, Q) chance that a tree in a wood is a conifer
    shore: NDArray[np.bool_]  # (Q, Q)


class GrowingGround(NamedTuple):
    """The ground for plants: where they grow and what they must stay away from."""

    corner: tuple[float, float]  # m
    heights: NDArray[np.float64]  # (R + 1, C + 1) m
    water_level: float  # m
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
    _mark_near_points(terrain.corner, doorsteps, near)
    _mark_near_lanes(terrain.corner, lanes, near)
    return GrowingGround(
        terrain.corner,
        terrain.heights,
        terrain.water_level,
        houses,
        placed,
        doorsteps,
        lanes,
        near,
        fields,
    )


@kernel
def _mark_near(corner: tuple[float, float], footprints: NDArray[np.float64], near: NDArray[np.bool_]) -> None:
    for number in range(footprints.shape[0]):
        footprint = footprints[number]
        low_x, high_x, low_z, high_z = np.inf, -np.inf, np.inf, -np.inf
        for end in range(4):
            x, z = corner_of(footprint, end)
            low_x, high_x, low_z, high_z = min(low_x, x), max(high_x, x), min(low_z, z), max(high_z, z)
        _mark_box(corner, low_x, low_z, high_x, high_z, near)


@kernel
def _mark_near_points(
    corner: tuple[float, float], points: NDArray[np.float64], near: NDArray[np.bool_]
) -> None:
    for number in range(points.shape[0]):
        x, z = points[number, 0], points[number, 1]
        _mark_box(corner, x, z, x, z, near)


@kernel
def _mark_near_lanes(
    corner: tuple[float, float], lanes: NDArray[np.float64], near: NDArray[np.bool_]
) -> None:
    for number in range(lanes.shape[0]):
        x0, z0, x1, z1 = lanes[number, 0], lanes[number, 1], lanes[number, 2], lanes[number, 3]
        _mark_box(corner, min(x0, x1), min(z0, z1), max(x0, x1), max(z0, z1), near)


@kernel
def _mark_box(
    corner: tuple[float, float],
    low_x: float,
    low_z: float,
    high_x: float,
    high_z: float,
    near: NDArray[np.bool_],
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
    return _patch(land.corner[1], z, count), _patch(land.corner[0], x, count)


@kernel
def _patch(corner: float, coordinate: float, count: int) -> int:
    return min(count - 1, max(0, int((coordinate - corner) / PATCH)))
