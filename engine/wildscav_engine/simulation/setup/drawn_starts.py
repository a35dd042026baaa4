"""The starts of a match and its target as its seed draws them: on a map's places, or around a target."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.arithmetic.random_numbers import Stream, Word, integer_in, normal, uniform_in
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.maps.walk.explore import walk_straight
from wildscav_engine.maps.walk.lattice import SAME_SURFACE, SPACING
from wildscav_engine.motion.collision import Bodies, Point
from wildscav_engine.specs.body import BODY_RADIUS, EDGE_MARGIN

START_TRIES = 64  # random draws of a start apart from the others, before all places are searched
START_DISTANCE = 3.0  # m between two starts, if the map has space
NEAR_DISTANCE = 4.0 * BODY_RADIUS  # m between two starts around a target, if the map has space
LEAST_DISTANCE = 2.0 * BODY_RADIUS + 2.0 * SKIN  # m between two starts: bodies never start inside each other
TARGET_DISTANCE = 10.0  # m, least distance from the first start to the target, if the map has space
KNOWN_PLACE = 6.0  # m, maximum distance of a start around the target from one of the map's places

STARTS, TARGET = int(Stream.STARTS), int(Stream.TARGET)
ALL_PLACED = -1  # in place of the first seat without a start


@kernel
def draw_starts(
    spawns: NDArray[np.float64], seed: Word, is_placed: NDArray[np.bool_], starts: NDArray[np.float64]
) -> int:
    """Draw the starts (A, 3) m that are not placed from a map's places (N, 3) m, apart from each other.

    If no draw is far enough from the other starts, the start is the place farthest from them. Writes
    ``starts`` and ``is_placed`` (A,), until a seat would start inside another; returns it, or ALL_PLACED.
    """
    for seat in range(starts.shape[0]):
        if is_placed[seat]:
            continue
        is_apart = False
        for attempt in range(START_TRIES):
            place = integer_in(0, spawns.shape[0] - 1, seed, STARTS, 0, seat, attempt)
            _put(spawns[place], starts[seat])
            is_apart = _distance_to_nearest(starts, is_placed, starts[seat]) >= START_DISTANCE
            if is_apart:
                break
        if not (is_apart or _take_farthest(spawns, starts, is_placed, seat)):
            return seat
        is_placed[seat] = True
    return ALL_PLACED


@kernel
def _put(place: NDArray[np.float64], start: NDArray[np.float64]) -> None:
    for axis in range(3):
        start[axis] = place[axis]


@kernel
def _distance_to_nearest(
    starts: NDArray[np.float64], is_placed: NDArray[np.bool_], place: NDArray[np.float64]
) -> float:
    """Return the horizontal distance in m from a place (3,) to the nearest start that is placed."""
    nearest = np.inf
    for other in range(starts.shape[0]):
        if is_placed[other]:
            dx, dz = place[0] - starts[other, 0], place[2] - starts[other, 2]
            nearest = min(nearest, dx * dx + dz * dz)
    return float(np.sqrt(nearest))


@kernel
def _take_farthest(
    spawns: NDArray[np.float64], starts: NDArray[np.float64], is_placed: NDArray[np.bool_], seat: int
) -> bool:
    """Write the place farthest from all placed starts; return False if a start is too close even there."""
    best, farthest = 0, -np.inf
    for place in range(spawns.shape[0]):
        distance = _distance_to_nearest(starts, is_placed, spawns[place])
        if distance > farthest:
            best, farthest = place, distance
    _put(spawns[best], starts[seat])
    return bool(farthest >= LEAST_DISTANCE)


@kernel
def draw_target(spawns: NDArray[np.float64], seed: Word, start: NDArray[np.float64]) -> int:
    """Return which of a map's places (N, 3) m is the target, away from the start (3,) m."""
    place = 0
    for attempt in range(START_TRIES):
        place = integer_in(0, spawns.shape[0] - 1, seed, TARGET, 0, 0, attempt)
        dx, dz = spawns[place, 0] - start[0], spawns[place, 2] - start[2]
        if dx * dx + dz * dz >= TARGET_DISTANCE * TARGET_DISTANCE:
            break
    return place


@kernel
def draw_place(spawns: NDArray[np.float64], seed: Word) -> int:
    """Return which of a map's places (N, 3) m is the target, regardless of the starts."""
    return integer_in(0, spawns.shape[0] - 1, seed, TARGET, 0, 0, 0)


@kernel
def draw_starts_near(
    world: World,
    no_bodies: Bodies,
    target: NDArray[np.float64],
    reach: float,
    spread: float,
    seed: Word,
    is_placed: NDArray[np.bool_],
    starts: NDArray[np.float64],
) -> int:
    """Draw the starts that are not placed around a target, as in the paper's navigation experiments.

    A start lies in a random direction from the target at the distance ``reach`` + |N(0, spread)| m, where a
    body can stand and reach the target. If no draw succeeds, it is the nearest of the map's places beyond
    ``reach`` that is apart from the other starts. Arrays and result are those of ``draw_starts``.
    """
    for seat in range(starts.shape[0]):
        if is_placed[seat]:
            continue
        is_found = False
        for attempt in range(START_TRIES):
            direction = uniform_in(0.0, 360.0, seed, STARTS, 0, seat, 2 * attempt)
            far = reach + abs(normal(seed, STARTS, 0, seat, 2 * attempt + 1)) * spread
            starts[seat, 0] = target[0] + far * sine(direction)
            starts[seat, 2] = target[2] + far * cosine(direction)
            starts[seat, 1] = _height_near(world, no_bodies, target, starts[seat, 0], starts[seat, 2])
            is_apart = _distance_to_nearest(starts, is_placed, starts[seat]) >= NEAR_DISTANCE
            is_found = is_apart and starts[seat, 1] > -np.inf
            if is_found:
                break
        for distance in (NEAR_DISTANCE, LEAST_DISTANCE):
            is_found = is_found or _take_nearest(
                world.spawns, target, reach, distance, starts, is_placed, seat
            )
        if not is_found:
            return seat
        is_placed[seat] = True
    return ALL_PLACED


@kernel
def _height_near(world: World, no_bodies: Bodies, target: NDArray[np.float64], x: float, z: float) -> float:
    """Return the height in m at which a body at (x, z) can stand and reach the target, or -inf.

    It can reach the target if it can walk straight there and back, or straight to one of the map's places
    nearby, from which every other can be reached.
    """
    rows, columns = world.water.shape
    east, north = world.corner[0] + columns * CELL, world.corner[1] + rows * CELL
    inside_x = world.corner[0] + EDGE_MARGIN <= x <= east - EDGE_MARGIN
    if not (inside_x and world.corner[1] + EDGE_MARGIN <= z <= north - EDGE_MARGIN):
        return -np.inf
    goal = Point(target[0], target[1], target[2])
    height = walk_straight(world, no_bodies, goal, x, z, SPACING)
    if height > -np.inf and is_clear(world, x, height, z):
        back = walk_straight(world, no_bodies, Point(x, height, z), goal.x, goal.z, SPACING)
        if abs(back - goal.y) <= SAME_SURFACE:
            return height
    height = ground_at(world, x, z).height
    if height < water_at(world, x, z) or not is_clear(world, x, height, z):
        return -np.inf
    here, spawns = Point(x, height, z), world.spawns
    for place in range(spawns.shape[0]):
        if abs(spawns[place, 0] - x) <= KNOWN_PLACE and abs(spawns[place, 2] - z) <= KNOWN_PLACE:
            arrival = walk_straight(world, no_bodies, here, spawns[place, 0], spawns[place, 2], SPACING)
            if abs(arrival - spawns[place, 1]) <= SAME_SURFACE:
                return height
    return -np.inf


@kernel
def _take_nearest(
    spawns: NDArray[np.float64],
    target: NDArray[np.float64],
    reach: float,
    distance: float,
    starts: NDArray[np.float64],
    is_placed: NDArray[np.bool_],
    seat: int,
) -> bool:
    """Write the place nearest to the target beyond ``reach`` m, ``distance`` m from all starts, if any."""
    best, nearest = -1, np.inf
    for place in range(spawns.shape[0]):
        dx, dz = spawns[place, 0] - target[0], spawns[place, 2] - target[2]
        away = dx * dx + dz * dz
        is_nearer = reach * reach < away < nearest
        if is_nearer and _distance_to_nearest(starts, is_placed, spawns[place]) >= distance:
            best, nearest = place, away
    if best < 0:
        return False
    _put(spawns[best], starts[seat])
    return True
