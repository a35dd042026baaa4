"""Scattering plants and rocks by rejection sampling, clear of houses, lanes, water and each other."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine
from wildscav_engine.arithmetic.random_numbers import Stream, uniform
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.segments import nearest_on
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.ground.terrain import distance_to_footprint, points_within
from wildscav_engine.maps.settlements.streets import height_at
from wildscav_engine.maps.vegetation.growing_ground import BUSHES, NEAR, ROCKS, TREES, GrowingGround, patch_of
from wildscav_engine.maps.vegetation.species import (
    BESIDE,
    BLOCK,
    BOULDER,
    BROADLEAF,
    BUSH,
    COLUMNS,
    CONIFER,
    CROWN,
    DEAD,
    DRAWS,
    GROUND,
    GROUP,
    HEDGE,
    HEIGHT,
    HIGHEST,
    KEY,
    LOWEST,
    MEMBER,
    MORE,
    POPLAR,
    RADIUS,
    SPECIES,
    STEPPING_STONE,
    X,
    Z,
    draw_size,
    is_rock,
    is_tree,
)

STREAM = int(Stream.VEGETATION)
TRIES = 40  # places tried for each plant
EDGE_MARGIN = 2.0  # m from the edge of the map
WALK = 1.6  # m between two plants, so that bodies can walk between them
HOUSE_MARGIN, CROWN_MARGIN = 1.7, 0.8  # m between a house and a plant's foot, or its crown
DOORSTEP_MARGIN, LANE_MARGIN = 3.0, 3.0  # m from a doorstep, and from a lane's axis
SHORE_MARGIN = 0.1  # m above the water
STEEPEST, STEEPEST_FOR_ROCKS = 0.8, 1.2  # m up per m
LINK = 4.0  # m, side of the cells that index plants; plants more than two cells apart never touch
HEDGE_STEP = 1.35  # distance between the bushes of a hedge, in radii
MAX_AROUND = 4  # members that touch the first of their group
TOUCH = 0.68  # distance between the axes of two touching plants, in sums of their radii


class Spots(NamedTuple):
    """The plants placed so far, with linked lists of those in each cell of 4 m."""

    rows: NDArray[np.float64]  # (N, COLUMNS), see ``species``
    first: NDArray[np.int64]  # (K, K) a plant in each cell, -1 for none
    following: NDArray[np.int64]  # (N,) the next plant in the same cell, -1 for none


def allocate_spots(size: int, most: int) -> Spots:
    """Return empty tables for ``most`` plants on a map of a size in m."""
    cells = int(size / LINK) + 1
    return Spots(np.zeros((most, COLUMNS)), np.full((cells, cells), -1), np.full(most, -1))


@kernel
def scatter(
    seed: np.uint64,
    first_key: int,
    category: int,
    wanted: int,
    area: NDArray[np.float64],
    land: GrowingGround,
    spots: Spots,
    found: int,
) -> int:
    """Add plants of one category by rejection sampling; those without a place are left out.

    They fill a footprint, (6,), and have consecutive keys from ``first_key`` on. The spots hold those found
    before, and have room for more. It returns the new number of plants.
    """
    last = min(found + wanted, spots.rows.shape[0])
    for number in range(wanted):
        if found >= last:
            break
        spot = spots.rows[found]
        for trial in range(TRIES):
            if not _try_place(seed, first_key + number, trial, category, area, land, spot):
                continue
            if can_stand(land, spots, found, found):
                link(land, spots, found)
                found = _add_group(seed, land, spots, found + 1, last, area)
                break
    return found


@kernel
def _try_place(
    seed: np.uint64,
    key: int,
    trial: int,
    category: int,
    area: NDArray[np.float64],
    land: GrowingGround,
    spot: NDArray[np.float64],
) -> bool:
    """Draw a place in an area, and the plant there; return whether the patch accepts it."""
    for draw in range(5):
        spot[DRAWS + draw] = uniform(seed, STREAM, key, trial, draw)
    across, along = area[4] * (2.0 * spot[DRAWS] - 1.0), area[5] * (2.0 * spot[DRAWS + 1] - 1.0)
    x = area[0] + across * area[3] + along * area[2]
    z = area[1] - across * area[2] + along * area[3]
    row, column = patch_of(land, x, z)
    if spot[DRAWS + 2] >= land.fields.weights[category, row, column]:
        return False
    spot[X], spot[Z], spot[KEY], spot[MEMBER] = x, z, key, 0
    spot[SPECIES] = _species(category, land, row, column, spot[DRAWS + 3], spot[DRAWS + 4])
    draw_size(seed, spot)
    return True


@kernel
def place_one(
    seed: np.uint64,
    key: int,
    category: int,
    x: float,
    z: float,
    land: GrowingGround,
    spots: Spots,
    found: int,
) -> None:
    """Put one plant exactly at a place in m, without any test."""
    row, column = patch_of(land, x, z)
    spot = spots.rows[found]
    spot[X], spot[Z], spot[KEY], spot[MEMBER] = x, z, key, 0
    for draw in range(2):
        spot[DRAWS + draw] = uniform(seed, STREAM, key, 0, draw)
    spot[SPECIES] = _species(category, land, row, column, spot[DRAWS], spot[DRAWS + 1])
    draw_size(seed, spot)
    survey(land, spot)
    link(land, spots, found)


@kernel
def _species(category: int, land: GrowingGround, row: int, column: int, choice: float, chance: float) -> int:
    """Return the species of a plant, by two random numbers from 0 to 1 and its patch."""
    if category == BUSHES:
        return BUSH
    if category == ROCKS:
        return STEPPING_STONE if choice < 0.3 else BLOCK if choice < 0.6 else BOULDER
    if chance < 0.04:
        return DEAD
    is_open = land.fields.weights[TREES, row, column] < 0.5
    if chance < (0.4 if land.fields.shore[row, column] else 0.2 if is_open else 0.06):
        return POPLAR
    return CONIFER if choice < land.fields.conifers[row, column] else BROADLEAF


@kernel
def can_stand(land: GrowingGround, spots: Spots, number: int, group: int) -> bool:
    """Return whether a plant can stand at its place; also write the heights of its ground.

    Only plants before ``group``, the first of its own, count as others: members of a group may touch.
    """
    spot = spots.rows[number]
    half = -land.terrain.corner[0] - EDGE_MARGIN
    if max(abs(spot[X]), abs(spot[Z])) + spot[RADIUS] > half + 0.5:
        return False
    survey(land, spot)
    lowest, highest = heights_within(land, spot[X], spot[Z], 0.0)
    steepest = STEEPEST_FOR_ROCKS if is_rock(spot[SPECIES]) else STEEPEST
    if min(lowest, spot[LOWEST]) < land.terrain.water_level + SHORE_MARGIN:
        return False
    if highest - lowest > steepest * CELL:
        return False
    row, column = patch_of(land, spot[X], spot[Z])
    if land.near[row, column] and not _is_clear(land, spot):
        return False
    return not _is_crowded(land, spots, spot, group)


@kernel
def survey(land: GrowingGround, spot: NDArray[np.float64]) -> None:
    """Write the heights of a plant's ground: at its axis, under its foot and under its crown."""
    spot[GROUND] = height_at(land.terrain, spot[X], spot[Z])
    spot[LOWEST] = heights_within(land, spot[X], spot[Z], spot[RADIUS])[0]
    spot[HIGHEST] = heights_within(land, spot[X], spot[Z], spot[CROWN])[1]


@kernel
def heights_within(land: GrowingGround, x: float, z: float, reach: float) -> tuple[float, float]:
    """Return the least and greatest height in m of the cells within reach of a place."""
    heights, corner = land.terrain.heights, land.terrain.corner
    first_row, last_row = points_within(corner[1], z, reach, heights.shape[0])
    first_column, last_column = points_within(corner[0], x, reach, heights.shape[1])
    lowest, highest = np.inf, -np.inf
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            lowest, highest = min(lowest, heights[row, column]), max(highest, heights[row, column])
    return lowest, highest


@kernel
def _is_clear(land: GrowingGround, spot: NDArray[np.float64]) -> bool:
    x, z, radius, crown = spot[X], spot[Z], spot[RADIUS], spot[CROWN]
    from_house = max(radius + HOUSE_MARGIN, crown + CROWN_MARGIN)
    for footprints in (land.houses, land.placed):
        for row in range(footprints.shape[0]):
            if distance_to_footprint(footprints[row], x, z) < from_house:
                return False
    for door in range(land.doorsteps.shape[0]):
        east, north = x - land.doorsteps[door, 0], z - land.doorsteps[door, 1]
        if east * east + north * north < (radius + DOORSTEP_MARGIN) * (radius + DOORSTEP_MARGIN):
            return False
    for lane in range(land.lanes.shape[0]):
        to_x, to_z = nearest_on(land.lanes[lane], x, z)
        east, north = x - to_x, z - to_z
        if east * east + north * north < (radius + LANE_MARGIN) * (radius + LANE_MARGIN):
            return False
    return True


@kernel
def least_distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the least distance in m between the axes of two plants of different groups."""
    apart = one[RADIUS] + other[RADIUS] + WALK
    if is_tree(one[SPECIES]) and is_tree(other[SPECIES]):
        return float(max(apart, 0.55 * (one[CROWN] + other[CROWN])))
    # Bodies climb rocks, so no crown hangs over them.
    if is_rock(one[SPECIES]) or is_rock(other[SPECIES]):
        return float(max(apart, one[RADIUS] + other[CROWN], one[CROWN] + other[RADIUS]))
    return float(apart)


@kernel
def _is_crowded(land: GrowingGround, spots: Spots, spot: NDArray[np.float64], group: int) -> bool:
    """Return whether another plant is too near; it searches the 25 cells around."""
    corner = land.terrain.corner
    row, column = int((spot[Z] - corner[1]) / LINK), int((spot[X] - corner[0]) / LINK)
    for near_row in range(max(0, row - 2), min(spots.first.shape[0], row + 3)):
        for near_column in range(max(0, column - 2), min(spots.first.shape[1], column + 3)):
            other = spots.first[near_row, near_column]
            while other >= 0:
                east, north = spot[X] - spots.rows[other, X], spot[Z] - spots.rows[other, Z]
                apart = least_distance(spot, spots.rows[other])
                if other < group and east * east + north * north < apart * apart:
                    return True
                other = spots.following[other]
    return False


@kernel
def link(land: GrowingGround, spots: Spots, number: int) -> None:
    """Insert a plant into the list of its cell."""
    row = int((spots.rows[number, Z] - land.terrain.corner[1]) / LINK)
    column = int((spots.rows[number, X] - land.terrain.corner[0]) / LINK)
    spots.following[number] = spots.first[row, column]
    spots.first[row, column] = number


@kernel
def _add_group(
    seed: np.uint64, land: GrowingGround, spots: Spots, found: int, last: int, area: NDArray[np.float64]
) -> int:
    """Add plants that touch the one added last: a hedge, a clump, or smaller rocks around a boulder."""
    group = found - 1
    leader = spots.rows[group]
    more = _members(land, leader)
    is_hedge = more > MAX_AROUND
    yaw = _yaw_of_hedge(land, leader) if is_hedge else 0.0
    for member in range(1, more + 1):
        if found >= last:
            break
        spot = spots.rows[found]
        spot[KEY], spot[MEMBER], spot[SPECIES] = leader[KEY], member, BUSH
        if leader[SPECIES] == BOULDER:
            spot[SPECIES] = BLOCK if member == 1 else STEPPING_STONE
        draw_size(seed, spot)
        away = TOUCH * (leader[RADIUS] + spot[RADIUS])
        if is_hedge:
            spot[RADIUS], spot[HEIGHT] = leader[RADIUS], leader[HEIGHT]
            away = member * HEDGE_STEP * leader[RADIUS]
        else:
            yaw = 360.0 * spot[BESIDE]
        spot[X], spot[Z] = leader[X] + away * sine(yaw), leader[Z] + away * cosine(yaw)
        if distance_to_footprint(area, spot[X], spot[Z]) == 0.0 and can_stand(land, spots, found, group):
            link(land, spots, found)
            found += 1
        elif is_hedge:
            break
    return found


@kernel
def _members(land: GrowingGround, leader: NDArray[np.float64]) -> int:
    """Return the number of further members of a group; more than MAX_AROUND means a hedge."""
    if leader[SPECIES] == BUSH:
        row, column = patch_of(land, leader[X], leader[Z])
        if leader[GROUP] < (0.5 if land.near[row, column] else 0.08):
            return MAX_AROUND + 1 + int(8.0 * leader[MORE])
        return int((MAX_AROUND + 1) * leader[MORE]) if leader[GROUP] < 0.75 else 0
    if leader[SPECIES] == BOULDER and leader[GROUP] < 0.75:
        return 1 + int(MAX_AROUND * leader[MORE])
    return 0


@kernel
def _yaw_of_hedge(land: GrowingGround, leader: NDArray[np.float64]) -> float:
    """Return the yaw in degrees of a hedge: aligned with the nearest house, if one is near."""
    yaw = 360.0 * leader[HEDGE]
    nearest = 1.5 * NEAR
    for house in range(land.houses.shape[0]):
        away = distance_to_footprint(land.houses[house], leader[X], leader[Z])
        if away < nearest:
            nearest = away
            quarter = 90.0 * int(yaw / 90.0)
            yaw = arctangent(land.houses[house, 2], land.houses[house, 3]) + quarter
    return float(yaw)
