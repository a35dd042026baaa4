"""The shortest way over the walkable graph, and that way pulled straight."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import array_kernel, kernel
from wildscav_engine.maps.walk.components import successor
from wildscav_engine.maps.walk.explore import leaves_room, walk_straight
from wildscav_engine.maps.walk.lattice import DIRECTIONS, SAME_SURFACE, SPACING
from wildscav_engine.systems.collision import Bodies, Point

HEAP_FIRST = 1  # the heap's root is at 1, so that the parent of i is i // 2
UNKNOWN = -1
LEG_STRIDE = 0.06  # m, of the walks that try whether a leg can be straight
LEG_ROOM = 0.1  # m to each side that a straight leg leaves


@array_kernel
def shortest_way(
    places: NDArray[np.float64],
    edges: NDArray[np.int32],
    leap_start: NDArray[np.int64],
    leap_end: NDArray[np.int32],
    start: int,
    end: int,
) -> NDArray[np.int32]:
    """Return the nodes of the shortest way over edges and leaps, both ends included; empty if none.

    A* (Hart, Nilsson & Raphael 1968); lengths are horizontal, as ``walked`` counts them.

    Args:
        places: (N, 3) m, of the nodes.
        edges: (N, 8) nodes, negative for none.
        leap_start: (N + 1,) where each node's leaps start.
        leap_end: (L,) nodes.
        start: Node.
        end: Node.
    """
    count = places.shape[0]
    length = np.full(count, np.inf)  # m, of the shortest way known from the start
    came = np.full(count, UNKNOWN, np.int32)
    done = np.zeros(count, np.bool_)
    heap = np.empty(16 * 1024, np.int32)
    urgency = np.empty(16 * 1024)
    length[start], heap[HEAP_FIRST], urgency[HEAP_FIRST], size = 0.0, start, 0.0, HEAP_FIRST
    while size >= HEAP_FIRST:
        node = heap[HEAP_FIRST]
        size = _pop(heap, urgency, size)
        if done[node]:
            continue
        done[node] = True
        if node == end:
            break
        number, other = 0, 0
        while other > -2:
            other = successor(node, number, edges, leap_start, leap_end)
            number += 1
            if other < 0 or done[other]:
                continue
            far = length[node] + _apart(places, node, other)
            if far < length[other]:
                length[other], came[other] = far, node
                if size + 1 == heap.shape[0]:
                    heap = np.concatenate((heap, np.empty_like(heap)))
                    urgency = np.concatenate((urgency, np.empty_like(urgency)))
                size = _push(heap, urgency, size, other, far + _apart(places, other, end))
    return _way_back(came, start, end) if done[end] else np.empty(0, np.int32)


@kernel
def _apart(places: NDArray[np.float64], one: int, other: int) -> float:
    """Return the horizontal distance in m between two nodes."""
    east, north = places[other, 0] - places[one, 0], places[other, 2] - places[one, 2]
    return float(np.sqrt(east * east + north * north))


@array_kernel
def _way_back(came: NDArray[np.int32], start: int, end: int) -> NDArray[np.int32]:
    """Return the way to the end, from where each node was come to."""
    steps, node = 1, end
    while node != start:
        node, steps = came[node], steps + 1
    way = np.empty(steps, np.int32)
    node = end
    for step in range(steps - 1, -1, -1):
        way[step] = node
        node = came[node]
    return way


@kernel
def _push(heap: NDArray[np.int32], urgency: NDArray[np.float64], size: int, node: int, key: float) -> int:
    """Put a node into a binary heap, the least key first, and return the heap's new size."""
    place = size + 1
    while place > HEAP_FIRST and urgency[place // 2] > key:
        heap[place], urgency[place] = heap[place // 2], urgency[place // 2]
        place //= 2
    heap[place], urgency[place] = node, key
    return size + 1


@kernel
def _pop(heap: NDArray[np.int32], urgency: NDArray[np.float64], size: int) -> int:
    """Take the first node out of a heap and return the heap's new size."""
    node, key = heap[size], urgency[size]
    place = HEAP_FIRST
    while 2 * place < size:
        child = 2 * place
        if child + 1 < size and urgency[child + 1] < urgency[child]:
            child += 1
        if urgency[child] >= key:
            break
        heap[place], urgency[place] = heap[child], urgency[child]
        place = child
    heap[place], urgency[place] = node, key
    return size - 1


@array_kernel
def pull_straight(
    world: World, nobody: Bodies, places: NDArray[np.float64], way: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the nodes that are left of a way where straight walks take the place of many short ones.

    Args:
        world: The static world.
        nobody: No bodies.
        places: (N, 3) m, of the nodes.
        way: Nodes, each of which can be walked to from the one before.
    """
    kept = np.empty_like(way)
    kept[0], count, at, last = way[0], 1, 0, len(way) - 1
    while at < last:
        at = _farthest_straight(world, nobody, places, way, at, last)
        kept[count] = way[at]
        count += 1
    return kept[:count].copy()


@kernel
def _farthest_straight(
    world: World, nobody: Bodies, places: NDArray[np.float64], way: NDArray[np.int32], first: int, last: int
) -> int:
    """Return the index of a node of a way, as far as possible, that can be walked to straight from another.

    After the last node it gallops ahead while straight walks arrive, then halves the gap; so it may miss one.
    """
    if first + 1 == last or _is_straight(world, nobody, places, way[first], way[last]):
        return last
    good, stride = first + 1, 2
    while good < last:
        ahead = min(last, first + stride)
        if not _is_straight(world, nobody, places, way[first], way[ahead]):
            break
        good, stride = ahead, 2 * stride
    bad = min(last, first + stride)
    while bad - good > 1:
        middle = (good + bad) // 2
        if _is_straight(world, nobody, places, way[first], way[middle]):
            good = middle
        else:
            bad = middle
    return good


@kernel
def _is_straight(world: World, nobody: Bodies, places: NDArray[np.float64], start: int, end: int) -> bool:
    """Return whether a body that walks straight from one node arrives at another."""
    at = Point(places[start, 0], places[start, 1], places[start, 2])
    x, height, z = places[end, 0], places[end, 1], places[end, 2]
    if x == at.x and z == at.z:
        return bool(abs(height - at.y) <= SAME_SURFACE)
    for stride in (SPACING, LEG_STRIDE):  # great strides are quickly stopped where nobody gets through
        if not abs(walk_straight(world, nobody, at, x, z, stride) - height) <= SAME_SURFACE:
            return False
    return leaves_room(world, nobody, at, x, z, height, LEG_ROOM, LEG_STRIDE)


@kernel
def is_edge(edges: NDArray[np.int32], start: int, end: int) -> bool:
    """Return whether a walk leads from one node to another."""
    leads_there = False
    for direction in range(DIRECTIONS):
        leads_there = leads_there or edges[start, direction] == end
    return leads_there
