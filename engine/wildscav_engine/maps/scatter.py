"""Where each plant and rock stands: by trial, where it grows, clear of houses, lanes, water, each other."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL
from wildscav_engine.kernel import kernel
from wildscav_engine.maps.footprints import corner_of, nearest_on_lane
from wildscav_engine.maps.plants import (
    BLOCK,
    BOULDER,
    BROADLEAF,
    BUSH,
    COLUMNS,
    CONIFER,
    CROWN,
    DEAD,
    GROUND,
    HEIGHT,
    HIGHEST,
    KEY,
    LOWEST,
    MEMBER,
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
from wildscav_engine.maps.streets import height_at
from wildscav_engine.maps.terrain import Terrain, distance_to_footprint
from wildscav_engine.maps.woods import PATCH
from wildscav_engine.rng import Stream, uniform, uniform_in
from wildscav_engine.trig import arctangent, cosine, sine

STREAM = int(Stream.VEGETATION)
TREES, BUSHES, ROCKS = range(3)  # what is scattered
TRIES = 40  # places tried for each plant
EDGE_MARGIN = 2.0  # m from the edge of the map
WALK = 1.6  # m between two things that stand on the ground, so that one walks between
HOUSE_MARGIN, CROWN_MARGIN = 1.7, 0.8  # m between a house and what stands on the ground, or a crown
DOORSTEP_MARGIN, LANE_MARGIN = 3.0, 3.0  # m from the place before a door, and from a lane's axis
SHORE_MARGIN = 0.1  # m above the water
STEEPEST, STEEPEST_FOR_ROCKS = 0.8, 1.2  # m up per m
LINK = 4.0  # m, side of the cells in which plants are found; things farther than two of them never meet
NEAR = 10.0  # m from a house, a doorstep or a lane, from where on none is looked for
HEDGE_STEP = 1.15  # m between the bushes of a hedge
TOUCH = 0.8  # distance between the axes of two things that touch, by the sum of their radii


class Fields(NamedTuple):
    """What grows where, on patches of 4 m."""

    weights: NDArray[np.float64]  # (3, Q, Q) chance that trees, bushes or rocks take to a patch
    conifers: NDArray[np.float64]  # (Q, Q) chance that a tree in a wood is a conifer
    shore: NDArray[np.bool_]  # (Q, Q)


class Land(NamedTuple):
    """What plants must keep off, and where they grow."""

    corner: tuple[float, float]  # m
    heights: NDArray[np.float64]  # (R + 1, C + 1) m
    water_level: float  # m
    houses: NDArray[np.float64]  # (H, 6) footprints
    placed: NDArray[np.float64]  # (P, 6) footprints of what is placed by hand
    doorsteps: NDArray[np.float64]  # (D, 2) m
    lanes: NDArray[np.float64]  # (L, 4) m
    near: NDArray[np.bool_]  # (Q, Q) patches near any of these
    fields: Fields


class Spots(NamedTuple):
    """The plants that stand so far, linked by the 4 m cells they stand in."""

    rows: NDArray[np.float64]  # (N, COLUMNS), see ``plants``
    first: NDArray[np.int64]  # (K, K) a plant in each cell, -1 for none
    following: NDArray[np.int64]  # (N,) the next plant in the same cell, -1 for none


def allocate_spots(size: int, most: int) -> Spots:
    """Return room for so many plants on a map of a size in m."""
    cells = int(size / LINK) + 1
    return Spots(np.zeros((most, COLUMNS)), np.full((cells, cells), -1), np.full(most, -1))


def land_of(
    terrain: Terrain,
    houses: NDArray[np.float64],
    placed: NDArray[np.float64],
    doorsteps: NDArray[np.float64],
    lanes: NDArray[np.float64],
    fields: Fields,
) -> Land:
    """Return a land (see ``Land``); marks the patches near what plants must keep off."""
    near = np.zeros(fields.shore.shape, np.bool_)
    _mark_near(terrain.corner, houses, near)
    _mark_near(terrain.corner, placed, near)
    _mark_near_points(terrain.corner, doorsteps, near)
    _mark_near_lanes(terrain.corner, lanes, near)
    return Land(
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
def _patch(corner: float, coordinate: float, count: int) -> int:
    return min(count - 1, max(0, int((coordinate - corner) / PATCH)))


@kernel
def scatter(
    seed: np.uint64,
    first_key: int,
    what: int,
    wanted: int,
    area: NDArray[np.float64],
    land: Land,
    spots: Spots,
    found: int,
) -> int:
    """Add plants of one sort, by trial; those without a place are left out.

    Args:
        seed: Of the map.
        first_key: The key of the first; the others have the next ones.
        what: TREES, BUSHES or ROCKS.
        wanted: How many at most.
        area: (6,) the footprint that they fill.
        land: What they must keep off, and where they grow.
        spots: Those that stand already; added to, as far as there is room.
        found: How many stand already.

    Returns:
        How many stand then.
    """
    last = min(found + wanted, spots.rows.shape[0])
    for number in range(wanted):
        if found >= last:
            break
        key = first_key + number
        for trial in range(TRIES):
            across = area[4] * uniform_in(-1.0, 1.0, seed, STREAM, key, trial, 0)
            along = area[5] * uniform_in(-1.0, 1.0, seed, STREAM, key, trial, 1)
            x = area[0] + across * area[3] + along * area[2]
            z = area[1] - across * area[2] + along * area[3]
            row, column = _patch_of(land, x, z)
            if uniform(seed, STREAM, key, trial, 2) >= land.fields.weights[what, row, column]:
                continue
            spot = spots.rows[found]
            spot[X], spot[Z], spot[KEY], spot[MEMBER] = x, z, key, 0
            spot[SPECIES] = draw_species(seed, key, what, land, row, column)
            draw_size(seed, spot)
            if can_stand(land, spots, found, found):
                link(land, spots, found)
                found = _add_group(seed, land, spots, found + 1, last, area)
                break
    return found


@kernel
def place_one(
    seed: np.uint64, key: int, what: int, x: float, z: float, land: Land, spots: Spots, found: int
) -> None:
    """Put one plant exactly at a place in m, whatever is there."""
    row, column = _patch_of(land, x, z)
    spot = spots.rows[found]
    spot[X], spot[Z], spot[KEY], spot[MEMBER] = x, z, key, 0
    spot[SPECIES] = draw_species(seed, key, what, land, row, column)
    draw_size(seed, spot)
    survey(land, spot)
    link(land, spots, found)


@kernel
def _patch_of(land: Land, x: float, z: float) -> tuple[int, int]:
    count = land.near.shape[0]
    return _patch(land.corner[1], z, count), _patch(land.corner[0], x, count)


@kernel
def draw_species(seed: np.uint64, key: int, what: int, land: Land, row: int, column: int) -> int:
    """Draw what exactly a plant is, from its key and where it stands."""
    choice, chance = uniform(seed, STREAM, key, 500, 0), uniform(seed, STREAM, key, 500, 1)
    if what == BUSHES:
        return BUSH
    if what == ROCKS:
        return STEPPING_STONE if choice < 0.3 else BLOCK if choice < 0.6 else BOULDER
    if chance < 0.04:
        return DEAD
    is_open = land.fields.weights[TREES, row, column] < 0.5
    if chance < (0.4 if land.fields.shore[row, column] else 0.2 if is_open else 0.06):
        return POPLAR
    return CONIFER if choice < land.fields.conifers[row, column] else BROADLEAF


@kernel
def can_stand(land: Land, spots: Spots, number: int, group: int) -> bool:
    """Return whether a plant has room where it is; fills in the heights of its ground.

    Args:
        land: What it must keep off.
        spots: All plants.
        number: Of the plant; only those before ``group`` count as others.
        group: The first plant of its group, whose members may touch it.

    Returns:
        Whether it has room.
    """
    spot = spots.rows[number]
    half = -land.corner[0] - EDGE_MARGIN
    if max(abs(spot[X]), abs(spot[Z])) + spot[RADIUS] > half + 0.5:
        return False
    survey(land, spot)
    lowest, highest = heights_within(land, spot[X], spot[Z], 0.0)
    steepest = STEEPEST_FOR_ROCKS if is_rock(spot[SPECIES]) else STEEPEST
    if min(lowest, spot[LOWEST]) < land.water_level + SHORE_MARGIN or highest - lowest > steepest * CELL:
        return False
    row, column = _patch_of(land, spot[X], spot[Z])
    if land.near[row, column] and not _is_clear(land, spot):
        return False
    return not _is_crowded(land, spots, spot, group)


@kernel
def survey(land: Land, spot: NDArray[np.float64]) -> None:
    """Fill in the heights of a plant's ground: at its axis, under its foot and under its crown."""
    spot[GROUND] = height_at(land.corner, land.heights, spot[X], spot[Z])
    spot[LOWEST] = heights_within(land, spot[X], spot[Z], spot[RADIUS])[0]
    spot[HIGHEST] = heights_within(land, spot[X], spot[Z], spot[CROWN])[1]


@kernel
def heights_within(land: Land, x: float, z: float, reach: float) -> tuple[float, float]:
    """Return the least and the greatest height in m of the cells within reach of a place."""
    heights, corner = land.heights, land.corner
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
def _is_clear(land: Land, spot: NDArray[np.float64]) -> bool:
    x, z, radius, crown = spot[X], spot[Z], spot[RADIUS], spot[CROWN]
    from_house = max(radius + HOUSE_MARGIN, crown + CROWN_MARGIN)
    for house in range(land.houses.shape[0]):
        if distance_to_footprint(land.houses[house], x, z) < from_house:
            return False
    for placed in range(land.placed.shape[0]):
        if distance_to_footprint(land.placed[placed], x, z) < from_house:
            return False
    for door in range(land.doorsteps.shape[0]):
        east, north = x - land.doorsteps[door, 0], z - land.doorsteps[door, 1]
        if east * east + north * north < (radius + DOORSTEP_MARGIN) * (radius + DOORSTEP_MARGIN):
            return False
    for lane in range(land.lanes.shape[0]):
        to_x, to_z = nearest_on_lane(land.lanes[lane], x, z)
        east, north = x - to_x, z - to_z
        if east * east + north * north < (radius + LANE_MARGIN) * (radius + LANE_MARGIN):
            return False
    return True


@kernel
def least_distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return how far in m the axes of two plants of different groups must be apart."""
    apart = one[RADIUS] + other[RADIUS] + WALK
    if is_tree(one[SPECIES]) and is_tree(other[SPECIES]):
        return float(max(apart, 0.55 * (one[CROWN] + other[CROWN])))
    # One climbs rocks, so no crown hangs over them.
    if is_rock(one[SPECIES]) or is_rock(other[SPECIES]):
        return float(max(apart, one[RADIUS] + other[CROWN], one[CROWN] + other[RADIUS]))
    return float(apart)


@kernel
def _is_crowded(land: Land, spots: Spots, spot: NDArray[np.float64], group: int) -> bool:
    """Return whether another plant is too near; looks at the 25 cells around."""
    row, column = int((spot[Z] - land.corner[1]) / LINK), int((spot[X] - land.corner[0]) / LINK)
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
def link(land: Land, spots: Spots, number: int) -> None:
    """Enter a plant into the cell it stands in."""
    row = int((spots.rows[number, Z] - land.corner[1]) / LINK)
    column = int((spots.rows[number, X] - land.corner[0]) / LINK)
    spots.following[number] = spots.first[row, column]
    spots.first[row, column] = number


@kernel
def _add_group(
    seed: np.uint64, land: Land, spots: Spots, found: int, last: int, area: NDArray[np.float64]
) -> int:
    """Let more of its kind touch the plant added last: a hedge, a clump, or smaller rocks at a boulder."""
    leader = spots.rows[found - 1]
    key, choice = int(leader[KEY]), uniform(seed, STREAM, int(leader[KEY]), 501, 0)
    if leader[SPECIES] == BUSH:
        row, column = _patch_of(land, leader[X], leader[Z])
        if choice < (0.5 if land.near[row, column] else 0.08):
            return _add_hedge(seed, land, spots, found, last, area)
        more = int(5.0 * uniform(seed, STREAM, key, 501, 1)) if choice < 0.75 else 0
        return _add_around(seed, land, spots, found, last, area, more, BUSH)
    if leader[SPECIES] == BOULDER and choice < 0.75:
        found = _add_around(seed, land, spots, found, last, area, 1, BLOCK)
        more = int(4.0 * uniform(seed, STREAM, key, 501, 1))
        return _add_around(seed, land, spots, found, last, area, more, STEPPING_STONE)
    return found


@kernel
def _add_member(land: Land, spots: Spots, found: int, group: int, x: float, z: float, species: int) -> bool:
    """Try to add a member to the group that starts with a plant; its size is drawn before its place."""
    spot = spots.rows[found]
    spot[X], spot[Z], spot[SPECIES] = x, z, species
    if can_stand(land, spots, found, group):
        link(land, spots, found)
        return True
    return False


@kernel
def _add_around(
    seed: np.uint64,
    land: Land,
    spots: Spots,
    found: int,
    last: int,
    area: NDArray[np.float64],
    more: int,
    species: int,
) -> int:
    """Add members of one species that touch the first of their group."""
    group = found - 1
    while spots.rows[group, MEMBER] > 0.0:
        group -= 1
    leader = spots.rows[group]
    for _ in range(more):
        if found >= last:
            break
        spot = spots.rows[found]
        spot[KEY], spot[MEMBER], spot[SPECIES] = leader[KEY], found - group, species
        draw_size(seed, spot)
        yaw = uniform_in(0.0, 360.0, seed, STREAM, int(leader[KEY]), 502, found - group)
        away = TOUCH * (leader[RADIUS] + spot[RADIUS])
        x, z = leader[X] + away * sine(yaw), leader[Z] + away * cosine(yaw)
        if _is_in(area, x, z) and _add_member(land, spots, found, group, x, z, species):
            found += 1
        else:
            break
    return found


@kernel
def _is_in(area: NDArray[np.float64], x: float, z: float) -> bool:
    return distance_to_footprint(area, x, z) == 0.0


@kernel
def _add_hedge(
    seed: np.uint64, land: Land, spots: Spots, found: int, last: int, area: NDArray[np.float64]
) -> int:
    """Add bushes in a row, in line with the nearest house where there is one near."""
    group = found - 1
    leader = spots.rows[group]
    key = int(leader[KEY])
    leader[RADIUS] = max(0.75, min(0.95, leader[RADIUS]))
    yaw = _yaw_of_hedge(seed, land, leader)
    for _ in range(4 + int(9.0 * uniform(seed, STREAM, key, 503, 1))):
        if found >= last:
            break
        spot, away = spots.rows[found], (found - group) * HEDGE_STEP
        spot[KEY], spot[MEMBER] = key, found - group
        spot[RADIUS], spot[CROWN], spot[HEIGHT] = leader[RADIUS], 0.0, leader[HEIGHT]
        x, z = leader[X] + away * sine(yaw), leader[Z] + away * cosine(yaw)
        if not (_is_in(area, x, z) and _add_member(land, spots, found, group, x, z, BUSH)):
            break
        found += 1
    return found


@kernel
def _yaw_of_hedge(seed: np.uint64, land: Land, leader: NDArray[np.float64]) -> float:
    yaw = uniform_in(0.0, 360.0, seed, STREAM, int(leader[KEY]), 503, 0)
    nearest = 1.5 * NEAR
    for house in range(land.houses.shape[0]):
        away = distance_to_footprint(land.houses[house], leader[X], leader[Z])
        if away < nearest:
            nearest = away
            quarter = 90.0 * int(yaw / 90.0)
            yaw = arctangent(land.houses[house, 2], land.houses[house, 3]) + quarter
    return yaw
