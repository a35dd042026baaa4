"""Leaps: getting down from an edge or a cliff, and jumping onto a solid.

A leap is a straight move to a lattice point that any agent can make: it may begin with a jump, and then
steers towards the point until the body stands there. Leaps are simulated frame by frame with the engine's
motion, so the graph has exactly those that work.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.clearance import has_clearance, is_clear
from wildscav_engine.geometry.sweep import sweep_world
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import SIDE_CLEARANCE, explore, join_diagonals
from wildscav_engine.maps.walk.lattice import (
    DIRECTIONS,
    EAST,
    FALLS,
    FINE,
    GETS_DOWN,
    NO_EDGE,
    NORTH,
    SAME_SURFACE,
    Nodes,
    Survey,
    add_node,
    is_gentle,
    neighbour,
    node_at,
    place_of,
)
from wildscav_engine.motion.body_motion import move
from wildscav_engine.motion.collision import Bodies, Point
from wildscav_engine.motion.walking import on_steep_ground
from wildscav_engine.specs.body import COS_SLOPE_LIMIT, STEP_HEIGHT, TAN_SLOPE_LIMIT
from wildscav_engine.specs.rules import FRAME

LEAP_SPEED = 5.0  # m/s, of a body that leaps
JUMP_HEIGHT = 1.2  # m, greatest height to jump onto: slightly less than the height of a jump
FARTHEST_LEAP = 4  # greatest length of a leap, in edges
DROP_FRAMES, JUMP_FRAMES = 150, 60  # longest duration of a leap
PROGRESS = 1e-3  # m; a standing body that moves less in a frame is stopped by something
ARRIVED = 0.01  # m; a standing body this near to the point has arrived
IN_WATER = 0.5  # factor of the speed in water, for leaps


class Leaps(NamedTuple):
    """The L leaps found so far, in tables with spare capacity."""

    start: NDArray[np.int32]  # (L,) node
    end: NDArray[np.int32]  # (L,) node
    jump: NDArray[np.bool_]  # (L,) whether it begins with a jump
    found: NDArray[np.int64]  # (1,) L


@kernel
def explore_further(survey: Survey, body: Bodies, leaps: Leaps, explored: NDArray[np.int64]) -> None:
    """Find straight edges, then diagonal ones, then leaps, until the tables have to grow.

    The first node without each of them is in ``explored``, (3,), and updated. One kernel does all three,
    because they share most of the code to compile.
    """
    nodes, capacity = survey.nodes, len(survey.nodes.point)
    explored[0] = explore(survey, explored[0], capacity)
    if explored[0] == nodes.found[0]:
        explored[1] = join_diagonals(survey, explored[1], capacity)
    if explored[1] == nodes.found[0]:
        room = (capacity, len(leaps.start))
        explored[2] = find_leaps(survey, body, leaps, explored[2], room)


@kernel
def find_leaps(survey: Survey, body: Bodies, leaps: Leaps, start: int, capacity: tuple[int, int]) -> int:
    """Find the leaps from the nodes that have all their edges, from ``start`` on.

    It returns the first node whose leaps are not known, like ``explore``.
    """
    nodes = survey.nodes
    last = int(nodes.found[0])
    for node in range(start, last):
        if nodes.found[0] + DIRECTIONS >= capacity[0] or leaps.found[0] + DIRECTIONS >= capacity[1]:
            return node
        is_down = False
        for direction in range(DIRECTIONS):
            if nodes.edges[node, direction] == FALLS and not is_down:
                # One leap down per neighbourhood is enough.
                is_down = _neighbour_gets_down(nodes, node)
                is_down = is_down or _get_down(survey, body, leaps, node, direction)
            elif nodes.edges[node, direction] == NO_EDGE:
                _get_up(survey, body, leaps, node, direction)
    return last


@kernel
def _neighbour_gets_down(nodes: Nodes, node: int) -> bool:
    """Return whether a neighbouring node already has a known leap down."""
    for direction in range(DIRECTIONS):
        other = nodes.edges[node, direction]
        if other >= 0:
            for way in range(DIRECTIONS):
                if nodes.edges[other, way] == GETS_DOWN:
                    return True
    return False


@kernel
def _get_down(survey: Survey, body: Bodies, leaps: Leaps, node: int, direction: int) -> bool:
    """Find a leap to the nearest point in a direction where a body that walks off an edge lands, if any."""
    world, _, lattice, nodes = survey
    point = int(nodes.point[node])
    away = abs(neighbour(lattice, point, direction) - point)
    units = 1 if away == 1 or abs(away - lattice.side) <= 1 else 2
    row, column = point // lattice.side, point % lattice.side
    for far in range(1, FARTHEST_LEAP + 1):
        to_row, to_column = row + far * units * NORTH[direction], column + far * units * EAST[direction]
        if min(to_row, to_column) < 2 or max(to_row, to_column) > lattice.side - 3:
            return False
        target = to_row * lattice.side + to_column
        x, z = place_of(world, lattice, target)
        height = landing_height(world, x, z, nodes.height[node])
        if height == -np.inf or not _can_be_node(survey, target, height):
            continue
        if _leap(survey, body, leaps, node, target, False):
            nodes.edges[node, direction] = GETS_DOWN
            return True
    return False


@kernel
def landing_height(world: World, x: float, z: float, top: float) -> float:
    """Return the height in m at which a body that falls straight down from ``top`` m lands.

    It is -inf where the body does not fit at the top, or would land on something too steep.
    """
    ground = ground_at(world, x, z).height
    if ground > top or not is_clear(world, x, top, z):
        return -np.inf
    contact = sweep_world(world, x, top, z, 0.0, ground - top, 0.0)
    if contact.fraction < 1.0:
        return top + (ground - top) * contact.fraction if contact.n_y >= COS_SLOPE_LIMIT else -np.inf
    return ground if is_gentle(world, x, z, TAN_SLOPE_LIMIT) else -np.inf


@kernel
def _can_be_node(survey: Survey, target: int, height: float) -> bool:
    """Return whether a node exists or can exist over a point at a height in m."""
    world, _, lattice, nodes = survey
    if node_at(nodes, target, height) >= 0:
        return True
    x, z = place_of(world, lattice, target)
    return bool(lattice.marks[target] == FINE and has_clearance(world, x, height, z, SIDE_CLEARANCE))


@kernel
def _get_up(survey: Survey, body: Bodies, leaps: Leaps, node: int, direction: int) -> None:
    """Find a jump onto a surface over a point that is higher than a step but not higher than a jump.

    Surfaces that already have a node are skipped: one jump onto a solid is enough.
    """
    world, _, lattice, nodes = survey
    target = neighbour(lattice, int(nodes.point[node]), direction)
    if target < 0 or lattice.marks[target] != FINE:
        return
    x, z = place_of(world, lattice, target)
    height = landing_height(world, x, z, nodes.height[node] + JUMP_HEIGHT)
    if height <= nodes.height[node] + STEP_HEIGHT or node_at(nodes, target, height) >= 0:
        return
    if _can_be_node(survey, target, height):
        _leap(survey, body, leaps, node, target, True)


@kernel
def _leap(survey: Survey, body: Bodies, leaps: Leaps, node: int, target: int, jump: bool) -> bool:
    """Try a leap to a lattice point; record it if it arrives, and return whether it does."""
    world, _, lattice, nodes = survey
    x, z = place_of(world, lattice, int(nodes.point[node]))
    to_x, to_z = place_of(world, lattice, target)
    start = Point(x, nodes.height[node], z)
    height = leap_height(world, body, start, to_x, to_z, jump)
    if height == -np.inf or not _leaves_clearance(world, body, start, to_x, to_z, jump, height):
        return False
    other = node_at(nodes, target, height)
    if other < 0 and _can_be_node(survey, target, height):
        other = add_node(nodes, target, height)
    if other < 0 or other == node:
        return False
    leap = int(leaps.found[0])
    leaps.start[leap], leaps.end[leap], leaps.jump[leap] = node, other, jump
    leaps.found[0] = leap + 1
    return True


@kernel
def _leaves_clearance(
    world: World, body: Bodies, start: Point, x: float, z: float, jump: bool, height: float
) -> bool:
    """Return whether a leap also arrives from slightly beside its start."""
    east, north = x - start.x, z - start.z
    share = SIDE_CLEARANCE / np.sqrt(east * east + north * north)
    for side in (-share, share):
        beside = Point(start.x - side * north, start.y, start.z + side * east)
        if not abs(leap_height(world, body, beside, x, z, jump) - height) <= SAME_SURFACE:
            return False
    return True


@kernel
def leap_height(world: World, body: Bodies, start: Point, x: float, z: float, jump: bool) -> float:
    """Simulate a leap; return the height in m at which the body stands at (x, z), -inf if it fails."""
    place = body.position[body.mover]
    place[0], place[1], place[2] = start.x, start.y, start.z
    rise, on_ground, before = 0.0, True, np.inf
    for frame in range(JUMP_FRAMES if jump else DROP_FRAMES):
        east, north = x - place[0], z - place[2]
        left = np.sqrt(east * east + north * north)
        if left < ARRIVED and on_ground and frame > 0:
            at = Point(place[0], place[1], place[2])
            return -np.inf if on_steep_ground(world, at) else at.y
        fell_short = jump and place[1] < start.y + STEP_HEIGHT
        if on_ground and frame > 0 and (fell_short or left > before - PROGRESS):
            return -np.inf  # stopped by something
        before = left
        speed = min(LEAP_SPEED, left / FRAME)
        heading = arctangent(east, north)
        moved = move(world, body, rise, on_ground, heading, speed, jump and frame == 0, IN_WATER)
        place[0], place[1], place[2] = moved.x, moved.y, moved.z
        rise, on_ground = moved.rise, moved.on_ground
    return -np.inf
