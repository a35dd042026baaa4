"""The lattice under the walkable graph, and the table of its nodes.

Lattice points are half a metre apart. In and around houses and on rocks (*fine* cells) every point may have
nodes; elsewhere only every other one, so nodes are a metre apart there. One point may have several nodes, on
floors above each other.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import CELL, Kind, World, cell_of
from wildscav_engine.motion.collision import Bodies
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, STEP_HEIGHT

SPACING = 0.5  # m between lattice points
POINTS = int(CELL / SPACING)  # lattice points along a cell
BORDER = 2  # lattice points along the edge of the map without nodes
DIRECTIONS = 8  # east, north-east, north … south-east; a diagonal has an odd number
EAST = (1, 1, 0, -1, -1, -1, 0, 1)
NORTH = (0, 1, 1, 1, 0, -1, -1, -1)
SAME_SURFACE = 0.15  # m; nodes over one point are farther apart than this

OPEN, NEAR, FINE = 0, 1, 2  # cells with no obstacle; with plants; with solids to walk in and on
# Edges that lead to no node. FALLS: a body walks off an edge there; GETS_DOWN: the same, and a leap down is
# known.
NO_EDGE, FALLS, GETS_DOWN = -1, -2, -3

ROCK, TRUNK, CROWN, BUSH = int(Kind.ROCK), int(Kind.TRUNK), int(Kind.CROWN), int(Kind.BUSH)
NEAR_REACH = 1.05  # m around a plant: no edge between open cells comes as near as a body's radius
FINE_REACH = BODY_RADIUS + 0.15  # m around built solids
SLOPE_PROBE = 0.05  # m around a node where the ground must be gentle


Position = NDArray[np.float64] | tuple[float, float, float]  # (3,) m


class Lattice(NamedTuple):
    """The lattice of a map."""

    side: int  # lattice points along each side of the map
    marks: NDArray[np.uint8]  # (side * side,) what the cell of each point is: OPEN, NEAR or FINE


class Nodes(NamedTuple):
    """The N nodes found so far, in tables with spare capacity."""

    first: NDArray[np.int32]  # (side * side,) the first node over each lattice point, -1: none
    point: NDArray[np.int32]  # (N,) lattice point: row * side + column
    height: NDArray[np.float64]  # (N,) m, where the soles are
    following: NDArray[np.int32]  # (N,) next node over the same point, -1: none
    edges: NDArray[np.int32]  # (N, 8) the node that a walk in each direction leads to, NO_EDGE …
    found: NDArray[np.int64]  # (1,) N


class Survey(NamedTuple):
    """What exploring a map works on, and the bodies around one that walks alone: none."""

    world: World
    no_bodies: Bodies
    lattice: Lattice
    nodes: Nodes


@array_kernel
def classify_cells(world: World) -> NDArray[np.uint8]:
    """Return (R, C) the mark of each cell by the solids in and around it: OPEN, NEAR or FINE."""
    rows, columns = world.water.shape
    cells = np.zeros((rows, columns), np.uint8)
    for solid in range(world.solid_kind.shape[0]):
        kind = world.solid_kind[solid]
        _mark(world, cells, solid, NEAR_REACH, NEAR)
        if kind not in (TRUNK, CROWN, BUSH):
            _mark(world, cells, solid, 0.0 if kind == ROCK else FINE_REACH, FINE)
    return cells


@kernel
def _mark(world: World, cells: NDArray[np.uint8], solid: int, reach: float, mark: int) -> None:
    """Mark the cells around a solid, except where it is so high that a body can walk under it."""
    rows, columns = cells.shape
    low, high = world.solid_low[solid], world.solid_high[solid]
    for row in range(
        cell_of(world.corner[1], low[2] - reach, rows), cell_of(world.corner[1], high[2] + reach, rows) + 1
    ):
        for column in range(
            cell_of(world.corner[0], low[0] - reach, columns),
            cell_of(world.corner[0], high[0] + reach, columns) + 1,
        ):
            south = max(world.heights[row, column], world.heights[row, column + 1])
            north = max(world.heights[row + 1, column], world.heights[row + 1, column + 1])
            if mark == FINE or low[1] < max(south, north) + BODY_HEIGHT + STEP_HEIGHT:
                cells[row, column] = max(cells[row, column], mark)


def make_lattice(world: World) -> Lattice:
    """Return the lattice of a world; a point between cells has the greatest of their marks."""
    cells = classify_cells(world).repeat(POINTS, axis=0).repeat(POINTS, axis=1)
    marks = np.zeros((len(cells) + 1, len(cells) + 1), np.uint8)
    for row in (0, 1):
        for column in (0, 1):
            part = marks[row : row + len(cells), column : column + len(cells)]
            np.maximum(part, cells, out=part)
    return Lattice(len(marks), marks.reshape(-1))


@kernel
def is_gentle(world: World, x: float, z: float, limit: float) -> bool:
    """Return whether all ground right around a point is less steep than a limit, m up per m."""
    for north in (-SLOPE_PROBE, SLOPE_PROBE):
        for east in (-SLOPE_PROBE, SLOPE_PROBE):
            ground = ground_at(world, x + east, z + north)
            steepness = ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z
            if steepness >= limit * limit:
                return False
    return True


@kernel
def place_of(world: World, lattice: Lattice, point: int) -> tuple[float, float]:
    """Return x and z in m of a lattice point."""
    return (
        world.corner[0] + SPACING * (point % lattice.side),
        world.corner[1] + SPACING * (point // lattice.side),
    )


@kernel
def neighbour(lattice: Lattice, point: int, direction: int) -> int:
    """Return the lattice point that an edge in a direction leads to, -1 if there is none.

    In fine cells it is the next point. Elsewhere it is the second next, and both points must be at whole
    metres.
    """
    row, column = point // lattice.side, point % lattice.side
    if lattice.marks[point] == FINE:
        target = _point_at(lattice, row + NORTH[direction], column + EAST[direction])
        if target >= 0 and lattice.marks[target] == FINE:
            return target
    if row % 2 or column % 2:
        return -1
    return _point_at(lattice, row + 2 * NORTH[direction], column + 2 * EAST[direction])


@kernel
def _point_at(lattice: Lattice, row: int, column: int) -> int:
    """Return the lattice point in a row and column, -1 if it is too near the edge of the map for a node."""
    if min(row, column) < BORDER or max(row, column) > lattice.side - 1 - BORDER:
        return -1
    return row * lattice.side + column


@kernel
def node_at(nodes: Nodes, point: int, height: float) -> int:
    """Return the node over a point at about a height in m, -1 if there is none."""
    node = int(nodes.first[point])
    while node >= 0 and abs(nodes.height[node] - height) > SAME_SURFACE:
        node = int(nodes.following[node])
    return node


@kernel
def add_node(nodes: Nodes, point: int, height: float) -> int:
    """Add a node over a point and return it. The tables must have capacity for it."""
    node = int(nodes.found[0])
    nodes.found[0] = node + 1
    nodes.point[node], nodes.height[node] = point, height
    nodes.following[node], nodes.first[point] = nodes.first[point], node
    for direction in range(DIRECTIONS):
        nodes.edges[node, direction] = NO_EDGE
    return node


@kernel
def distance(one: Position, other: Position) -> float:
    """Return the distance in m between two places."""
    dx, dy, dz = other[0] - one[0], other[1] - one[1], other[2] - one[2]
    return float(np.sqrt(dx * dx + dy * dy + dz * dz))


@kernel
def level_distance(one: Position, other: Position) -> float:
    """Return the horizontal distance in m between two places."""
    east, north = other[0] - one[0], other[2] - one[2]
    return float(np.sqrt(east * east + north * north))
