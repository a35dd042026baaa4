"""Hiding targets upstairs, in other rooms and at dead ends, and measuring the ways from everywhere there."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.compilation.kernel import array_kernel
from wildscav_engine.maps.country.landforms import wards_at
from wildscav_engine.maps.country.plan import CountryPlan
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.walk.graph import NavGraph, Network, successor
from wildscav_engine.maps.walk.lattice import SPACING, Lattice, Nodes, node_at
from wildscav_engine.maps.walk.search import HEAP_FIRST, pop, push

# Edges have eight directions, so a route of edges can be longer than the way by this factor, 1 / cos(22.5°).
LONGER = 1.0823922002923940
UPSTAIRS, INDOORS, DEAD_ENDS = 6, 4, 6  # targets of each kind, if the map has them
NEAREST = 1.0  # m, the least straight distance that detours are measured over


@array_kernel
def _reverse(network: Network) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return where the sources of each node start, (N + 1,), and all sources, (E,): nodes that lead there."""
    count = network.edges.shape[0]
    first = np.zeros(count + 2, np.int64)
    for node in range(count):
        number, other = 0, 0
        while other > -2:
            other = successor(network, node, number)
            number += 1
            if other >= 0:
                first[other + 2] += 1
    for node in range(count):
        first[node + 2] += first[node + 1]
    sources = np.empty(first[count + 1], np.int32)
    for node in range(count):
        number, other = 0, 0
        while other > -2:
            other = successor(network, node, number)
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


@array_kernel
def _nodes_of(
    corner: NDArray[np.float64], lattice: Lattice, nodes: Nodes, places: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return (P,) the nodes at places (P, 3) m, -1 where there is none."""
    found = np.empty(len(places), np.int64)
    for index in range(len(places)):
        column = int((places[index, 0] - corner[0]) / SPACING + 0.5)
        row = int((places[index, 2] - corner[1]) / SPACING + 0.5)
        found[index] = node_at(nodes, row * lattice.side + column, places[index, 1])
    return found


class Hidden(NamedTuple):
    """The places where the target of a match may be, and how long the ways to them are."""

    places: NDArray[np.float64]  # (T, 3) m
    # (T, S) how many times as long as the straight line the way from each of the map's starts is, at least
    detours: NDArray[np.float32]


def hide_targets(
    graph: NavGraph,
    plan: CountryPlan,
    terrain: Terrain,
    houses: Sequence[House],
    indoor: NDArray[np.float64],
    ground: NDArray[np.float64],
    seed: int,
) -> Hidden:
    """Choose where targets may be, and measure the ways to them from the starts: places on open ground."""
    is_upstairs = np.zeros(len(indoor), np.bool_)
    for house in houses:
        is_upstairs |= house.covers(indoor) & (indoor[:, 1] > house.ground + house.storey_height / 2.0)
    is_dead_end = plan.wards.ways[wards_at(plan.wards, terrain, ground[:, 0], ground[:, 2])] == 1
    dice = RandomStream(seed, Stream.HIDING)
    chosen = [
        _draw(dice, indoor[is_upstairs], UPSTAIRS),
        _draw(dice, indoor[~is_upstairs], INDOORS),
        _draw(dice, ground[is_dead_end], DEAD_ENDS),
    ]
    return measure(graph, np.concatenate(chosen), ground)


def _draw(dice: RandomStream, places: NDArray[np.float64], wanted: int) -> NDArray[np.float64]:
    """Return at most some of the places, drawn at random."""
    left = list(range(len(places)))
    chosen = [left.pop(dice.integer(0, len(left) - 1)) for _ in range(min(wanted, len(left)))]
    return places[chosen]


def measure(graph: NavGraph, targets: NDArray[np.float64], starts: NDArray[np.float64]) -> Hidden:
    """Measure the ways to targets (T, 3) m from starts (S, 3) m; all of them are nodes of the graph."""
    positions, (first, sources) = graph.positions(), _reverse(graph.network)
    from_nodes, to_nodes = (
        _nodes_of(graph.world.corner, graph.lattice, graph.nodes, places) for places in (starts, targets)
    )
    detours = np.zeros((len(targets), len(starts)), np.float32)
    for row, node in enumerate(to_nodes.tolist()):
        way = distances_to(positions, first, sources, node)[from_nodes] / LONGER
        east, north = starts[:, 0] - targets[row, 0], starts[:, 2] - targets[row, 2]
        detours[row] = way / np.maximum(NEAREST, np.sqrt(east * east + north * north))
    return Hidden(targets, detours)
