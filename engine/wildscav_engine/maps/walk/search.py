"""Searching the shortest route over the walkable graph, and straightening it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import leaves_clearance, walk_straight
from wildscav_engine.maps.walk.graph import Network, successor
from wildscav_engine.maps.walk.lattice import DIRECTIONS, SAME_SURFACE, SPACING
from wildscav_engine.motion.collision import Bodies, Point

ON_LINE = 1e-9  # m
HEAP_FIRST = 1  # the heap's root is at 1, so that the parent of i is i // 2
UNKNOWN = -1
LEG_STRIDE = 0.06  # m, of the walks that test whether a leg can be straight
LEG_CLEARANCE = 0.1  # m that a straight leg leaves free on each side


class Routes(NamedTuple):
    """What a search knows about the shortest route from the start to each of N nodes."""

    length: NDArray[np.float64]  # (N,) m, inf: none yet
    previous: NDArray[np.int32]  # (N,) the node before, by an edge or a leap
    turn: NDArray[np.int32]  # (N,) the last turn before it, from where the route is straight
    done: NDArray[np.bool_]  # (N,)


@kernel
def follow_line(
    places: NDArray[np.float64], edges: NDArray[np.int32], start: int, end: int, along: NDArray[np.int32]
) -> int:
    """Return the number of edges on the straight line from a node to another; 0 if it is not free.

    The nodes after the start up to the end are written to ``along``, up to its size.
    """
    east, north = places[end, 0] - places[start, 0], places[end, 2] - places[start, 2]
    most = int(2.0 * (abs(east) + abs(north)) / SPACING) + 2
    node, steps = start, 0
    while node != end:
        node = _next_along(places, edges, start, node, end)
        if node < 0 or steps == most:
            return 0
        if steps < along.shape[0]:
            along[steps] = node
        steps += 1
    return steps


@kernel
def _next_along(
    places: NDArray[np.float64], edges: NDArray[np.int32], start: int, node: int, end: int
) -> int:
    """Return the next node along the line from ``start`` to ``end``, -1 where the line is not free."""
    to_east, to_north = places[end, 0] - places[node, 0], places[end, 2] - places[node, 2]
    straight, diagonal = _directions(to_east, to_north)
    needs_straight = abs(abs(to_east) - abs(to_north)) > ON_LINE
    needs_diagonal = min(abs(to_east), abs(to_north)) > ON_LINE
    by_straight, by_diagonal = int(edges[node, straight]), int(edges[node, diagonal])
    if (needs_straight and by_straight < 0) or (needs_diagonal and by_diagonal < 0):
        return -1
    if not needs_diagonal:
        return by_straight
    if not needs_straight:
        return by_diagonal
    off_straight = _off_line(places, start, end, by_straight)
    return by_straight if off_straight <= _off_line(places, start, end, by_diagonal) else by_diagonal


@kernel
def _directions(east: float, north: float) -> tuple[int, int]:
    """Return the straight and the diagonal direction (of ``lattice.DIRECTIONS``) that enclose a vector."""
    across, along = 0 if east > 0.0 else 4, 2 if north > 0.0 else 6
    straight = across if abs(east) >= abs(north) else along
    if east > 0.0:
        return straight, 1 if north > 0.0 else 7
    return straight, 3 if north > 0.0 else 5


@kernel
def _off_line(places: NDArray[np.float64], start: int, end: int, node: int) -> float:
    """Return the distance of a node from a line, in m times the line's length."""
    east, north = places[end, 0] - places[start, 0], places[end, 2] - places[start, 2]
    to_east, to_north = places[node, 0] - places[start, 0], places[node, 2] - places[start, 2]
    return float(abs(east * to_north - north * to_east))


@array_kernel
def shortest_route(places: NDArray[np.float64], network: Network, start: int, end: int) -> NDArray[np.int32]:
    """Return the nodes of the shortest route over edges and leaps, both ends included; empty without one.

    Lazy Theta* (Nash, Koenig & Tovey 2010): A* with straight lines of any angle between nodes, so that the
    eight directions of edges do not make routes longer. Line of sight between a node and the turn before it
    is assumed when the node is found, and checked when the search expands it. Lengths are horizontal, like
    ``walked``.
    """
    count, edges = places.shape[0], network.edges
    length, done = np.full(count, np.inf), np.zeros(count, np.bool_)
    previous, turn = np.full(count, UNKNOWN, np.int32), np.full(count, UNKNOWN, np.int32)
    routes = Routes(length, previous, turn, done)
    heap = np.empty(16 * 1024, np.int32)
    priority = np.empty(16 * 1024)
    nowhere = np.empty(0, np.int32)
    length[start], heap[HEAP_FIRST], priority[HEAP_FIRST], size = 0.0, start, 0.0, HEAP_FIRST
    turn[start] = start
    while size >= HEAP_FIRST:
        node = heap[HEAP_FIRST]
        size = pop(heap, priority, size)
        if done[node]:
            continue
        done[node] = True
        is_seen = turn[node] == previous[node] or follow_line(places, edges, turn[node], node, nowhere) > 0
        if node != start and not is_seen:
            _turn_before(places, edges, routes, node)
        if node == end:
            break
        number, other = 0, 0
        while other > -2:
            other = successor(network, node, number)
            number += 1
            if other < 0 or done[other]:
                continue
            # A straight line cannot start before a leap and end after it.
            before = turn[node] if number <= DIRECTIONS else node
            far = length[before] + _distance(places, before, other)
            if far < length[other]:
                length[other], previous[other], turn[other] = far, node, before
                if size + 1 == heap.shape[0]:
                    heap = np.concatenate((heap, np.empty_like(heap)))
                    priority = np.concatenate((priority, np.empty_like(priority)))
                size = push(heap, priority, size, other, far + _distance(places, other, end))
    return _trace_back(places, edges, routes, start, end) if done[end] else nowhere


@kernel
def _turn_before(places: NDArray[np.float64], edges: NDArray[np.int32], routes: Routes, node: int) -> None:
    """Turn the route to a node at its best neighbour, since the assumed turn has no line of sight to it."""
    length, previous, turn, done = routes
    best = previous[node]
    shortest = length[best] + _distance(places, best, node)
    for direction in range(DIRECTIONS):
        other = edges[node, direction]
        if other >= 0 and done[other] and edges[other, (direction + DIRECTIONS // 2) % DIRECTIONS] == node:
            far = length[other] + _distance(places, other, node)
            if far < shortest:
                best, shortest = other, far
    length[node], previous[node], turn[node] = shortest, best, best


@kernel
def _distance(places: NDArray[np.float64], one: int, other: int) -> float:
    """Return the horizontal distance in m between two nodes."""
    east, north = places[other, 0] - places[one, 0], places[other, 2] - places[one, 2]
    return float(np.sqrt(east * east + north * north))


@array_kernel
def _trace_back(
    places: NDArray[np.float64], edges: NDArray[np.int32], routes: Routes, start: int, end: int
) -> NDArray[np.int32]:
    """Return the nodes of the route to the end, including those along its straight parts."""
    previous, turn = routes.previous, routes.turn
    steps, node = 1, end
    nowhere = np.empty(0, np.int32)
    while node != start:
        steps += 1 if turn[node] == previous[node] else follow_line(places, edges, turn[node], node, nowhere)
        node = turn[node]
    route = np.empty(steps, np.int32)
    node, last = end, steps - 1
    route[last] = end
    while node != start:
        before = turn[node]
        if before == previous[node]:
            last -= 1
        else:
            far = follow_line(places, edges, before, node, nowhere)
            follow_line(places, edges, before, node, route[last - far + 1 : last + 1])
            last -= far
        route[last] = before
        node = before
    return route


@kernel
def push(heap: NDArray[np.int32], priority: NDArray[np.float64], size: int, node: int, key: float) -> int:
    """Insert a node into a binary min-heap and return the heap's new size."""
    place = size + 1
    while place > HEAP_FIRST and priority[place // 2] > key:
        heap[place], priority[place] = heap[place // 2], priority[place // 2]
        place //= 2
    heap[place], priority[place] = node, key
    return size + 1


@kernel
def pop(heap: NDArray[np.int32], priority: NDArray[np.float64], size: int) -> int:
    """Remove the first node from a heap and return the heap's new size."""
    node, key = heap[size], priority[size]
    place = HEAP_FIRST
    while 2 * place < size:
        child = 2 * place
        if child + 1 < size and priority[child + 1] < priority[child]:
            child += 1
        if priority[child] >= key:
            break
        heap[place], priority[place] = heap[child], priority[child]
        place = child
    heap[place], priority[place] = node, key
    return size - 1


@array_kernel
def pull_straight(
    world: World, no_bodies: Bodies, places: NDArray[np.float64], route: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the nodes of a walked route that remain when straight walks replace many short ones."""
    kept = np.empty_like(route)
    kept[0], count, at, last = route[0], 1, 0, len(route) - 1
    while at < last:
        at = _farthest_straight(world, no_bodies, places, route, at)
        kept[count] = route[at]
        count += 1
    return kept[:count].copy()


@kernel
def _farthest_straight(
    world: World, no_bodies: Bodies, places: NDArray[np.float64], route: NDArray[np.int32], first: int
) -> int:
    """Return the index of the farthest node of a route that a straight walk from ``first`` is found to reach.

    It is a galloping search: strides double while straight walks arrive, then the gap is halved. So it may
    miss a farther node.
    """
    last = len(route) - 1
    if first + 1 == last or _is_straight(world, no_bodies, places, route[first], route[last]):
        return last
    good, stride = first + 1, 2
    while good < last:
        ahead = min(last, first + stride)
        if not _is_straight(world, no_bodies, places, route[first], route[ahead]):
            break
        good, stride = ahead, 2 * stride
    bad = min(last, first + stride)
    while bad - good > 1:
        middle = (good + bad) // 2
        if _is_straight(world, no_bodies, places, route[first], route[middle]):
            good = middle
        else:
            bad = middle
    return good


@kernel
def _is_straight(world: World, no_bodies: Bodies, places: NDArray[np.float64], start: int, end: int) -> bool:
    """Return whether a straight walk leads from one node to another; see ``is_straight``."""
    here, there = places[start], places[end]
    return is_straight(
        world, no_bodies, Point(here[0], here[1], here[2]), Point(there[0], there[1], there[2])
    )


@kernel
def is_straight(world: World, no_bodies: Bodies, at: Point, end: Point) -> bool:
    """Return whether a straight walk leads from one place to another, with clearance on both sides."""
    x, height, z = end.x, end.y, end.z
    if x == at.x and z == at.z:
        return bool(abs(height - at.y) <= SAME_SURFACE)
    for stride in (SPACING, LEG_STRIDE):  # large strides fail quickly where the path is blocked
        if not abs(walk_straight(world, no_bodies, at, x, z, stride) - height) <= SAME_SURFACE:
            return False
    return leaves_clearance(world, no_bodies, at, end, LEG_CLEARANCE, LEG_STRIDE)
