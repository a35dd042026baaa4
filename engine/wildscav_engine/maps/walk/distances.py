"""The walking distances from all places of a map to one of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel
from wildscav_engine.maps.walk.graph import NavGraph, successor
from wildscav_engine.maps.walk.lattice import SPACING, Lattice, Nodes, node_at
from wildscav_engine.maps.walk.search import HEAP_FIRST, pop, push

# Edges have eight directions, so a route of edges can be longer than the way by this factor, 1 / cos(22.5°).
LONGER = 1.0823922002923940


class Sources(NamedTuple):
    """The edges and leaps of a walkable graph, by the nodes that they lead to."""

    first: NDArray[np.int64]  # (N + 1,) where the sources of each node start
    node: NDArray[np.int32]  # (E,) from which an edge or leap leads there


def sources_of(graph: NavGraph) -> Sources:
    """Return the edges and leaps of a graph, reversed."""
    return Sources(*_reverse(graph.nodes.edges, graph.leap_start, graph.leap_end))


@array_kernel
def _reverse(
    edges: NDArray[np.int32], leap_start: NDArray[np.int64], leap_end: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    count = edges.shape[0]
    first = np.zeros(count + 2, np.int64)
    for node in range(count):
        number, other = 0, 0
        while other > -2:
            other = successor(node, number, edges, leap_start, leap_end)
            number += 1
            if other >= 0:
                first[other + 2] += 1
    for node in range(count):
        first[node + 2] += first[node + 1]
    sources = np.empty(first[count + 1], np.int32)
    for node in range(count):
        number, other = 0, 0
        while other > -2:
            other = successor(node, number, edges, leap_start, leap_end)
            number += 1
            if other >= 0:
                sources[first[other + 1]] = node
                first[other + 1] += 1
    return first[: count + 1].copy(), sources


@array_kernel
def distances_to(
    places: NDArray[np.float64], first: NDArray[np.int64], sources: NDArray[np.int32], end: int
) -> NDArray[np.float64]:
    """Return (N,) m, horizontal, the length of the shortest route of edges from each node to one; inf: none.

    Dijkstra, "A Note on Two Problems in Connexion with Graphs", Numerische Mathematik 1 (1959), backwards.
    """
    count = places.shape[0]
    far = np.full(count, np.inf)
    done = np.zeros(count, np.bool_)
    heap, priority = np.empty(16 * 1024, np.int32), np.empty(16 * 1024)
    far[end], heap[HEAP_FIRST], priority[HEAP_FIRST], size = 0.0, end, 0.0, HEAP_FIRST
    while size >= HEAP_FIRST:
        node = heap[HEAP_FIRST]
        size = pop(heap, priority, size)
        if done[node]:
            continue
        done[node] = True
        for source in range(first[node], first[node + 1]):
            other = sources[source]
            east, north = places[other, 0] - places[node, 0], places[other, 2] - places[node, 2]
            length = far[node] + np.sqrt(east * east + north * north)
            if length < far[other]:
                far[other] = length
                if size + 1 == heap.shape[0]:
                    heap = np.concatenate((heap, np.empty_like(heap)))
                    priority = np.concatenate((priority, np.empty_like(priority)))
                size = push(heap, priority, size, other, length)
    return far


def nodes_of(graph: NavGraph, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return (P,) the nodes at places (P, 3) m, -1 where there is none."""
    return np.asarray(_nodes_of(graph.world.corner, graph.lattice, graph.nodes, places))


@array_kernel
def _nodes_of(
    corner: NDArray[np.float64], lattice: Lattice, nodes: Nodes, places: NDArray[np.float64]
) -> NDArray[np.int64]:
    found = np.empty(len(places), np.int64)
    for index in range(len(places)):
        column = int((places[index, 0] - corner[0]) / SPACING + 0.5)
        row = int((places[index, 2] - corner[1]) / SPACING + 0.5)
        found[index] = node_at(nodes, row * lattice.side + column, places[index, 1])
    return found
