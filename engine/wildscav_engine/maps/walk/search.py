"""The shortest way over the walkable graph, and that way pulled straight."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.components import successor
from wildscav_engine.maps.walk.explore import leaves_room, walk_straight
from wildscav_engine.maps.walk.lattice import DIRECTIONS, SAME_SURFACE, SPACING
from wildscav_engine.maps.walk.lines import follow_line
from wildscav_engine.motion.collision import Bodies, Point

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

    Lazy Theta* (Nash, Koenig & Tovey 2010): A* whose ways run straight between nodes at any angle, so that
    the eight directions of edges make none longer. That a node is seen from the turn before it is assumed
    when it is found, and checked when the search comes to it. Lengths are horizontal, like ``walked``.

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
    came = np.full(count, UNKNOWN, np.int32)  # the node before, by an edge or a leap
    turn = np.full(count, UNKNOWN, np.int32)  # the last turn before, from where the way is straight
    done = np.zeros(count, np.bool_)
    heap = np.empty(16 * 1024, np.int32)
    urgency = np.empty(16 * 1024)
    nowhere = np.empty(0, np.int32)
    length[start], heap[HEAP_FIRST], urgency[HEAP_FIRST], size = 0.0, start, 0.0, HEAP_FIRST
    turn[start] = start
    while size >= HEAP_FIRST:
        node = heap[HEAP_FIRST]
        size = _pop(heap, urgency, size)
        if done[node]:
            continue
        done[node] = True
        is_seen = turn[node] == came[node] or follow_line(places, edges, turn[node], node, nowhere) > 0
        if node != start and not is_seen:
            _turn_before(places, edges, done, length, came, turn, node)
        if node == end:
            break
        number, other = 0, 0
        while other > -2:
            other = successor(node, number, edges, leap_start, leap_end)
            number += 1
            if other < 0 or done[other]:
                continue
            # Behind a leap, no way is straight from before it.
            before = turn[node] if number <= DIRECTIONS else node
            far = length[before] + _apart(places, before, other)
            if far < length[other]:
                length[other], came[other], turn[other] = far, node, before
                if size + 1 == heap.shape[0]:
                    heap = np.concatenate((heap, np.empty_like(heap)))
                    urgency = np.concatenate((urgency, np.empty_like(urgency)))
                size = _push(heap, urgency, size, other, far + _apart(places, other, end))
    return _way_back(places, edges, came, turn, start, end) if done[end] else nowhere


@kernel
def _turn_before(
    places: NDArray[np.float64],
    edges: NDArray[np.int32],
    done: NDArray[np.bool_],
    length: NDArray[np.float64],
    came: NDArray[np.int32],
    turn: NDArray[np.int32],
    node: int,
) -> None:
    """Let the way to a node that is not seen from the turn before it turn at its best neighbour instead."""
    best = came[node]
    shortest = length[best] + _apart(places, best, node)
    for direction in range(DIRECTIONS):
        other = edges[node, direction]
        if other >= 0 and done[other] and edges[other, (direction + DIRECTIONS // 2) % DIRECTIONS] == node:
            far = length[other] + _apart(places, other, node)
            if far < shortest:
                best, shortest = other, far
    length[node], came[node], turn[node] = shortest, best, best


@kernel
def _apart(places: NDArray[np.float64], one: int, other: int) -> float:
    """Return the horizontal distance in m between two nodes."""
    east, north = places[other, 0] - places[one, 0], places[other, 2] - places[one, 2]
    return float(np.sqrt(east * east + north * north))


@array_kernel
def _way_back(
    places: NDArray[np.float64],
    edges: NDArray[np.int32],
    came: NDArray[np.int32],
    turn: NDArray[np.int32],
    start: int,
    end: int,
) -> NDArray[np.int32]:
    """Return the nodes of the way to the end, those along its straight parts included."""
    steps, node = 1, end
    nowhere = np.empty(0, np.int32)
    while node != start:
        steps += 1 if turn[node] == came[node] else follow_line(places, edges, turn[node], node, nowhere)
        node = turn[node]
    way = np.empty(steps, np.int32)
    node, last = end, steps - 1
    way[last] = end
    while node != start:
        before = turn[node]
        if before == came[node]:
            last -= 1
        else:
            far = follow_line(places, edges, before, node, nowhere)
            follow_line(places, edges, before, node, way[last - far + 1 : last + 1])
            last -= far
        way[last] = before
        node = before
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
    here, there = places[start], places[end]
    return is_straight(world, nobody, Point(here[0], here[1], here[2]), Point(there[0], there[1], there[2]))


@kernel
def is_straight(world: World, nobody: Bodies, at: Point, end: Point) -> bool:
    """Return whether a body that walks straight from a place arrives at another, with room to each side."""
    x, height, z = end.x, end.y, end.z
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
