"""A reference for the shortest way: A* search over a grid of 20 cm about the start, in 32 directions.

It shares with the engine only the question whether a body gets straight from one point to another.
"""

import heapq
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import leaves_clearance, walk_within
from wildscav_engine.maps.walk.fine_search import EXACT
from wildscav_engine.motion.collision import Bodies, Point

GRID = 0.2  # m
STRIDE = 0.1  # m
CLEARANCE = 0.15  # m on each side, so that no move squeezes through what a body would be stuck in
STEPS = range(-3, 4)
MOVES = [(x, z, GRID * math.hypot(x, z)) for x in STEPS for z in STEPS if math.gcd(x, z) == 1]
Move = tuple[int, int, float]
Node = tuple[int, int, int]  # column and row from the start, and height in units of 0.3 m


def reference_length(world: World, start: Any, target: Any, reach: float, bound: float) -> float:
    """Return the length in m of the shortest way found; inf if there is none within the bound."""
    no_bodies = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)
    first: Node = (0, 0, round(start[1] / 0.3))
    place: dict[Node, NDArray[np.float64]] = {first: np.array(start, np.float64)}
    length, before, done = {first: 0.0}, dict[Node, Node](), set[Node]()
    heap = [(0.0, first)]
    while heap:
        _, node = heapq.heappop(heap)
        if node in done:
            continue
        done.add(node)
        here = place[node]
        if math.dist(here, target) <= reach:
            return _pulled(world, no_bodies, _route(node, place, before))
        moves = [move for move in MOVES if _may_help(start, target, reach, bound, node, move, length)]
        heights = np.empty(len(moves))
        spots = np.array([_spot(start, node, move) for move in moves]).reshape(-1, 2)
        _walk_all(world, no_bodies, here, spots, node != first, heights)
        for move, (x, z), height in zip(moves, spots.tolist(), heights.tolist(), strict=True):
            other = (
                node[0] + move[0],
                node[1] + move[1],
                round(height / 0.3) if abs(height) < math.inf else 0,
            )
            gone = length[node] + move[2]
            if abs(height) < math.inf and gone < length.get(other, math.inf):
                length[other], before[other], place[other] = gone, node, np.array((x, height, z))
                heapq.heappush(
                    heap, (gone + max(0.0, math.hypot(x - target[0], z - target[2]) - reach), other)
                )
    return math.inf


def _spot(start: Any, node: Node, move: Move) -> tuple[float, float]:
    return start[0] + GRID * (node[0] + move[0]), start[2] + GRID * (node[1] + move[1])


def _may_help(
    start: Any, target: Any, reach: float, bound: float, node: Node, move: Move, length: dict[Node, float]
) -> bool:
    """Return whether a move may lead to a shorter way than the known ones, within the bound."""
    x, z = _spot(start, node, move)
    gone = length[node] + move[2]
    levels = [(node[0] + move[0], node[1] + move[1], node[2] + rise) for rise in (-2, -1, 0, 1, 2)]
    near = max(0.0, math.hypot(x - target[0], z - target[2]) - reach)
    return gone + near <= bound and not any(length.get(level, math.inf) <= gone for level in levels)


def _route(
    node: Node, place: dict[Node, NDArray[np.float64]], before: dict[Node, Node]
) -> NDArray[np.float64]:
    route = [node]
    while route[-1] in before:
        route.append(before[route[-1]])
    return np.array([place[one] for one in reversed(route)])


@kernel
def _walk_all(
    world: World,
    no_bodies: Bodies,
    here: NDArray[np.float64],
    spots: NDArray[np.float64],
    needs_clearance: bool,
    heights: NDArray[np.float64],
) -> None:
    for spot in range(spots.shape[0]):
        heights[spot] = _height_at(world, no_bodies, here, spots[spot, 0], spots[spot, 1], needs_clearance)


@kernel
def _height_at(
    world: World, no_bodies: Bodies, here: NDArray[np.float64], x: float, z: float, needs_clearance: bool
) -> float:
    """Return the height at which a body arrives that walks to x and z, -inf or NaN if it does not arrive."""
    start = Point(here[0], here[1], here[2])
    height = walk_within(world, no_bodies, start, x, z, STRIDE, EXACT)
    if not needs_clearance or not abs(height) < np.inf:
        return height
    end = Point(x, height, z)
    return height if leaves_clearance(world, no_bodies, start, end, CLEARANCE, STRIDE) else -np.inf


def _pulled(world: World, no_bodies: Bodies, route: NDArray[np.float64]) -> float:
    """Return the length of the shortest chain of straight walks among the points of a route."""
    length = np.full(len(route), np.inf)
    _pull(world, no_bodies, route, length)
    return float(length[-1])


@kernel
def _pull(world: World, no_bodies: Bodies, route: NDArray[np.float64], length: NDArray[np.float64]) -> None:
    length[0] = 0.0
    for end in range(1, route.shape[0]):
        for start in range(end - 1, -1, -1):
            east, north = route[end, 0] - route[start, 0], route[end, 2] - route[start, 2]
            far = length[start] + np.sqrt(east * east + north * north)
            if far < length[end] - 1e-9:
                height = _height_at(world, no_bodies, route[start], route[end, 0], route[end, 2], start > 0)
                if start == end - 1 or abs(height - route[end, 1]) <= 0.15:
                    length[end] = far
