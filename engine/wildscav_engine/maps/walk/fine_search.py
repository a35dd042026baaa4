"""Searching the shortest route over a grid finer than the walkable graph, to wherever a target is near.

The graph's nodes are half a metre apart, a metre on open ground, so it lacks ways through narrower gaps. Here
grid points are a quarter of a metre apart, and a body walks between them with the engine's own motion, in
sixteen directions. Only the points that a route of at most a known length can touch are looked at. Leaps are
those of the graph, whose nodes are all on the grid.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import NO_BODIES, SIDE_CLEARANCE, leaves_clearance, walk_within
from wildscav_engine.maps.walk.graph import NavGraph, Network
from wildscav_engine.maps.walk.lattice import (
    BORDER,
    OPEN,
    SAME_SURFACE,
    SPACING,
    Lattice,
    Nodes,
    distance,
    is_gentle,
    node_at,
)
from wildscav_engine.maps.walk.search import pop, push
from wildscav_engine.motion.collision import Bodies, Point
from wildscav_engine.specs.body import TAN_SLOPE_LIMIT

FINENESS = 2  # grid points along the distance of two lattice points
STEP = SPACING / FINENESS  # m between grid points
STRIDE = 0.2  # m, of the walks between them: as far as a body gets in a frame
EAST = (1, 2, 1, 1, 0, -1, -1, -2, -1, -2, -1, -1, 0, 1, 1, 2)  # grid points, of the sixteen moves
NORTH = (0, 1, 1, 2, 1, 2, 1, 1, 0, -1, -1, -2, -1, -2, -1, -1)
MOVES = len(EAST)
AROUND = 2  # grid points in each direction to which a body walks from a start that is not on the grid
EXACT = 1e-6  # m; a body that is nearer than this to a grid point is there
RISE = 0.6  # m, by which the heights at both ends of a move differ at most
MAX_MOVES = 64  # from one place, with leaps
NONE, FULL = -1, -2  # instead of a place found: there is none, or the tables are full


class Grid(NamedTuple):
    """The part of the fine grid in which a route is searched."""

    row: int  # of its first points, counted from the corner of the map
    column: int
    rows: int
    columns: int


class Found(NamedTuple):
    """The N places found so far, in tables with room for more. The first is the start."""

    first: NDArray[np.int32]  # (rows * columns,) the first place over each grid point, -1: none
    point: NDArray[np.int32]  # (N,) grid point: row * columns + column; -1 for the start
    place: NDArray[np.float64]  # (N, 3) m, soles
    following: NDArray[np.int32]  # (N,) next place over the same point, -1: none
    length: NDArray[np.float64]  # (N,) m, of the shortest known route from the start
    before: NDArray[np.int32]  # (N,) the place before it on that route
    leapt: NDArray[np.bool_]  # (N,) whether a leap leads from there
    done: NDArray[np.bool_]  # (N,)
    heap: NDArray[np.int32]  # (H,)
    priority: NDArray[np.float64]  # (H,) m, the least length of a route over the place
    counts: NDArray[np.int64]  # (2,) N, and the number of places in the heap


class Goal(NamedTuple):
    """Where a route shall lead, and how long it may be."""

    target: NDArray[np.float64]  # (3,) m
    reach: float  # m, 3D, from which the target is reached
    bound: float  # m


class Search(NamedTuple):
    """A search, with what it looks at and what it has found."""

    world: World
    nobody: Bodies
    lattice: Lattice
    nodes: Nodes
    network: Network  # with the leaps
    grid: Grid
    found: Found
    goal: Goal


def fine_route(
    graph: NavGraph, start: NDArray[np.float64], goal: Goal
) -> tuple[NDArray[np.float64], NDArray[np.bool_]] | None:
    """Return the shortest route from (3,) m to where the target is reached, None if there is none.

    It is given by its places, (P, 3) m with the start, and (P,) whether a leap leads to each.
    """
    grid = _grid_around(graph, start, goal)
    tables = graph.lattice, graph.nodes, graph.network
    capacity = 16 * 1024
    while True:
        found = _no_places(grid, capacity)
        last = search_on(Search(graph.world, NO_BODIES, *tables, grid, found, goal), start)
        if last != FULL:
            break
        capacity *= 4
    if last == NONE:
        return None
    route = [last]
    while route[-1] != 0:
        route.append(int(found.before[route[-1]]))
    along = np.array(route[::-1])
    return found.place[along], found.leapt[along]


def _grid_around(graph: NavGraph, start: NDArray[np.float64], goal: Goal) -> Grid:
    """Return the part of the grid that routes within the bound can touch."""
    low, high, corner = [], [], graph.world.corner
    last = FINENESS * (graph.lattice.side - 1 - BORDER)
    for axis, origin in ((2, corner[1]), (0, corner[0])):
        ends = sorted((float(start[axis]), float(goal.target[axis])))
        beside = 0.5 * max(0.0, goal.bound + goal.reach - (ends[1] - ends[0])) + STEP
        low.append(max(FINENESS * BORDER, int((ends[0] - beside - origin) / STEP)))
        high.append(min(last, int((ends[1] + beside - origin) / STEP) + 1))
    return Grid(low[0], low[1], max(1, high[0] - low[0] + 1), max(1, high[1] - low[1] + 1))


def _no_places(grid: Grid, capacity: int) -> Found:
    return Found(
        first=np.full(grid.rows * grid.columns, NONE, np.int32),
        point=np.empty(capacity, np.int32),
        place=np.empty((capacity, 3)),
        following=np.empty(capacity, np.int32),
        length=np.empty(capacity),
        before=np.empty(capacity, np.int32),
        leapt=np.zeros(capacity, np.bool_),
        done=np.zeros(capacity, np.bool_),
        heap=np.empty(4 * capacity, np.int32),
        priority=np.empty(4 * capacity),
        counts=np.zeros(2, np.int64),
    )


@kernel
def search_on(search: Search, start: NDArray[np.float64]) -> int:
    """Return the place where the shortest route reaches the target, NONE or FULL: A* over the fine grid."""
    found, goal, columns = search.found, search.goal, search.grid.columns
    _relax(found, goal, NONE, NONE, Point(start[0], start[1], start[2]), 0.0, False)
    room, room_in_heap = found.point.shape[0] - MAX_MOVES, found.heap.shape[0] - MAX_MOVES
    while found.counts[1] > 0:
        place = int(found.heap[1])
        found.counts[1] = pop(found.heap, found.priority, found.counts[1])
        if found.done[place]:
            continue
        found.done[place] = True
        if distance(found.place[place], goal.target) <= goal.reach:
            return place
        if found.counts[0] >= room or found.counts[1] >= room_in_heap:
            return FULL
        if place == 0:
            _leave_start(search)
        else:
            row, column = found.point[place] // columns, found.point[place] % columns
            for move in range(MOVES):
                _go(search, place, row + NORTH[move], column + EAST[move])
            _leap(search, place, row, column)
    return NONE


@kernel
def _leave_start(search: Search) -> None:
    """Walk from the start to the grid points around it."""
    start, world, grid = search.found.place[0], search.world, search.grid
    near_row = int((start[2] - world.corner[1]) / STEP + 0.5) - grid.row
    near_column = int((start[0] - world.corner[0]) / STEP + 0.5) - grid.column
    for row in range(near_row - AROUND, near_row + AROUND + 1):
        for column in range(near_column - AROUND, near_column + AROUND + 1):
            _go(search, 0, row, column)


@kernel
def _go(search: Search, place: int, row: int, column: int) -> None:
    """Walk from a place to a grid point, unless no shorter route can come of it."""
    world, nobody, lattice, _, _, grid, found, goal = search
    if not (0 <= row < grid.rows and 0 <= column < grid.columns):
        return
    x = world.corner[0] + STEP * (grid.column + column)
    z = world.corner[1] + STEP * (grid.row + row)
    here = Point(found.place[place, 0], found.place[place, 1], found.place[place, 2])
    length = found.length[place] + np.sqrt((x - here.x) * (x - here.x) + (z - here.z) * (z - here.z))
    point = row * grid.columns + column
    if length + _left(goal, x, z) > goal.bound or _is_known(found, point, here.y, length):
        return
    height = -np.inf
    if place != 0 and _is_open(lattice, grid, row, column):
        from_row, from_column = found.point[place] // grid.columns, found.point[place] % grid.columns
        if _is_open(lattice, grid, from_row, from_column):
            height = _height_on_open_ground(world, here, x, z)
    if height == -np.inf:
        height = _height_after_walk(world, nobody, here, x, z, place != 0)
    if abs(height) < np.inf:
        _relax(found, goal, place, point, Point(x, height, z), length, False)


@kernel
def _height_after_walk(
    world: World, nobody: Bodies, here: Point, x: float, z: float, with_clearance: bool
) -> float:
    """Return the height in m at which a body arrives, -inf or NaN if it does not.

    Nothing may be touched on the way: whoever arrived a centimetre off could stand in a wall when it goes on
    from the place, and then leave the wall on its other side. A start may be so close to a wall that there is
    no clearance beside it.
    """
    height = walk_within(world, nobody, here, x, z, STRIDE, EXACT)
    if not with_clearance or not abs(height) < np.inf:
        return height
    there = Point(x, height, z)
    return height if leaves_clearance(world, nobody, here, there, SIDE_CLEARANCE, STRIDE) else -np.inf


@kernel
def _is_known(found: Found, point: int, height: float, length: float) -> bool:
    """Return whether a route that is no longer leads to the surface over a point that a move may reach."""
    other = int(found.first[point])
    while other >= 0:
        if abs(found.place[other, 1] - height) <= RISE and found.length[other] <= length:
            return True
        other = int(found.following[other])
    return False


@kernel
def _is_open(lattice: Lattice, grid: Grid, row: int, column: int) -> bool:
    """Return whether all lattice points around a grid point are open."""
    row, column = row + grid.row, column + grid.column
    for near_row in (row // FINENESS, (row + 1) // FINENESS):
        for near_column in (column // FINENESS, (column + 1) // FINENESS):
            if lattice.marks[near_row * lattice.side + near_column] != OPEN:
                return False
    return True


@kernel
def _height_on_open_ground(world: World, here: Point, x: float, z: float) -> float:
    """Return the height in m at the other end of a move between open points, -inf if it needs a walk.

    As in ``explore.py``, nothing is in the way, and the ground is gentle between two ends where it is.
    """
    if is_gentle(world, here.x, here.z, TAN_SLOPE_LIMIT) and is_gentle(world, x, z, TAN_SLOPE_LIMIT):
        return float(ground_at(world, x, z).height)
    return -np.inf


@kernel
def _leap(search: Search, place: int, row: int, column: int) -> None:
    """Take the leaps of the graph's node at a place, if there is one."""
    world, _, lattice, nodes, network, grid, found, goal = search
    side, corner = lattice.side, world.corner
    row, column = row + grid.row, column + grid.column
    if row % FINENESS != 0 or column % FINENESS != 0:
        return
    lattice_point = row // FINENESS * side + column // FINENESS
    node = node_at(nodes, lattice_point, found.place[place, 1])
    if node < 0:
        return
    for leap in range(network.leap_start[node], network.leap_start[node + 1]):
        end = network.leap_end[leap]
        to_row = FINENESS * (nodes.point[end] // side) - grid.row
        to_column = FINENESS * (nodes.point[end] % side) - grid.column
        if 0 <= to_row < grid.rows and 0 <= to_column < grid.columns:
            x = corner[0] + STEP * (grid.column + to_column)
            z = corner[1] + STEP * (grid.row + to_row)
            east, north = x - found.place[place, 0], z - found.place[place, 2]
            length = found.length[place] + np.sqrt(east * east + north * north)
            point = to_row * grid.columns + to_column
            if length + _left(goal, x, z) <= goal.bound:
                _relax(found, goal, place, point, Point(x, nodes.height[end], z), length, True)


@kernel
def _relax(
    found: Found, goal: Goal, before: int, point: int, place: Point, length: float, leapt: bool
) -> None:
    """Add a place, or the shorter route to a known one."""
    x, y, z = place
    other = int(found.first[point]) if point >= 0 else NONE
    while other >= 0 and abs(found.place[other, 1] - y) > SAME_SURFACE:
        other = int(found.following[other])
    if other < 0:
        other = int(found.counts[0])
        found.counts[0] = other + 1
        found.point[other], found.length[other] = point, np.inf
        found.place[other, 0], found.place[other, 1], found.place[other, 2] = x, y, z
        if point >= 0:
            found.following[other], found.first[point] = found.first[point], other
    if not found.done[other] and length < found.length[other]:
        found.length[other], found.before[other], found.leapt[other] = length, before, leapt
        key = length + _left(goal, x, z)
        found.counts[1] = push(found.heap, found.priority, found.counts[1], other, key)


@kernel
def _left(goal: Goal, x: float, z: float) -> float:
    """Return the least length in m of a way from a place to where the target is reached."""
    east, north = goal.target[0] - x, goal.target[2] - z
    return max(0.0, float(np.sqrt(east * east + north * north)) - goal.reach)
