"""The walkable graph of a map: the places where a body can stand, and the walks and leaps between them."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import NO_BODIES, add_ground
from wildscav_engine.maps.walk.lattice import (
    BORDER,
    DIRECTIONS,
    FINE,
    SPACING,
    Lattice,
    Nodes,
    Survey,
    make_lattice,
)
from wildscav_engine.maps.walk.leaps import Leaps, explore_further
from wildscav_engine.motion.collision import Bodies

LAYERS = 2.0  # initial capacity, in nodes per lattice point in a house; tables grow when needed
Number = TypeVar("Number", bound=np.generic)
LEAPS_PER_NODE = 0.1  # initial capacity


class Network(NamedTuple):
    """The edges and leaps of a graph of N nodes, for kernels."""

    edges: NDArray[np.int32]  # (N, 8) the node that a walk in each direction leads to; below 0: none
    leap_start: NDArray[np.int64]  # (N + 1,) where each node's leaps start
    leap_end: NDArray[np.int32]  # (L,) node


@kernel
def successor(network: Network, node: int, number: int) -> int:
    """Return the node that the edge or leap of a number leads to; -1 for none, -2 past the last."""
    if number < DIRECTIONS:
        return max(-1, int(network.edges[node, number]))
    leap = network.leap_start[node] + number - DIRECTIONS
    return int(network.leap_end[leap]) if leap < network.leap_start[node + 1] else -2


@array_kernel
def strong_components(network: Network) -> NDArray[np.int32]:
    """Return (N,) the number of the strongly connected component of every node.

    Tarjan, "Depth-First Search and Linear Graph Algorithms", SIAM J. Comput. 1 (1972), with an explicit stack
    instead of recursion.
    """
    count = network.edges.shape[0]
    component = np.full(count, -1, np.int32)
    order = np.full(count, -1, np.int32)  # the order in which nodes were entered
    low = np.empty(count, np.int32)  # the earliest node on the stack known to be reachable from each
    following = np.zeros(count, np.int32)  # number of the next edge to follow
    path = np.empty(count, np.int32)  # from the root to the current node
    stack = np.empty(count, np.int32)  # entered, but not yet in a component
    entered, stacked, components = 0, 0, 0
    for root in range(count):
        if order[root] >= 0:
            continue
        path[0], depth = root, 1
        while depth > 0:
            node = path[depth - 1]
            if following[node] == 0 and order[node] < 0:
                order[node], low[node] = entered, entered
                entered += 1
                stack[stacked] = node
                stacked += 1
            other = successor(network, node, following[node])
            following[node] += 1
            if other == -2:
                depth -= 1
                if depth > 0:
                    low[path[depth - 1]] = min(low[path[depth - 1]], low[node])
                if low[node] == order[node]:
                    while True:
                        stacked -= 1
                        component[stack[stacked]] = components
                        if stack[stacked] == node:
                            break
                    components += 1
            elif other >= 0 and order[other] < 0:
                path[depth] = other
                depth += 1
            elif other >= 0 and component[other] < 0:
                low[node] = min(low[node], order[other])
    return component


@dataclass(frozen=True, eq=False)
class NavGraph:
    """Where a body can stand, and where it can walk, climb, drop and jump to from there.

    Edges and leaps are directed: after a drop from a roof there may be no path back.
    """

    world: World
    lattice: Lattice
    nodes: Nodes  # N nodes
    leap_start: NDArray[np.int64]  # (N + 1,) where each node's leaps start
    leap_end: NDArray[np.int32]  # (L,) node
    leap_jump: NDArray[np.bool_]  # (L,) whether a leap begins with a jump

    @property
    def network(self) -> Network:
        """Its edges and leaps."""
        return Network(self.nodes.edges, self.leap_start, self.leap_end)

    def __len__(self) -> int:
        """Return the number of nodes."""
        return len(self.nodes.point)

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """(N,) the number of each node's strongly connected component."""
        return strong_components(self.network)

    @cached_property
    def connected(self) -> NDArray[np.bool_]:
        """(N,) whether a node is in the largest strongly connected component."""
        if len(self) == 0:
            return np.zeros(0, np.bool_)
        return np.asarray(self.component == np.bincount(self.component).argmax())

    @property
    def ground_share(self) -> float:
        """The share of the map's ground that is connected, 0–1, counted at whole-metre points."""
        row, column = self.nodes.point // self.lattice.side, self.nodes.point % self.lattice.side
        whole = self.connected & (row % 2 == 0) & (column % 2 == 0)
        across = (self.lattice.side - 1 - 2 * BORDER) // 2 + 1
        has_node = np.zeros(len(self.lattice.marks), np.bool_)
        has_node[self.nodes.point[whole]] = True
        return int(np.count_nonzero(has_node)) / (across * across)

    def positions(self, chosen: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return (N, 3) m the positions of some nodes (or all), soles."""
        which = np.arange(len(self)) if chosen is None else np.asarray(chosen)
        point = self.nodes.point[which]
        places = np.empty((len(point), 3))
        places[:, 0] = self.world.corner[0] + SPACING * (point % self.lattice.side)
        places[:, 1] = self.nodes.height[which]
        places[:, 2] = self.world.corner[1] + SPACING * (point // self.lattice.side)
        return places


def build_graph(world: World) -> NavGraph:
    """Find every place that the engine's motion can walk, climb, drop and jump to on a map."""
    lattice = make_lattice(world)
    whole = lattice.side // 2 + 1
    fine = np.count_nonzero(lattice.marks == FINE)
    nodes = _no_nodes(lattice, int(whole * whole + LAYERS * fine) + 4 * DIRECTIONS)
    most = int(LEAPS_PER_NODE * len(nodes.point))
    start, end = np.empty(most, np.int32), np.empty(most, np.int32)
    leaps = Leaps(start, end, np.empty(most, np.bool_), np.zeros(1, np.int64))
    for row in range(BORDER, lattice.side - BORDER, 2):
        add_ground(world, lattice, nodes, row)
    nodes, leaps = _explore_all(world, lattice, nodes, leaps)
    return _finish(world, lattice, nodes, leaps)


def _no_nodes(lattice: Lattice, capacity: int) -> Nodes:
    return Nodes(
        first=np.full(lattice.side * lattice.side, -1, np.int32),
        point=np.empty(capacity, np.int32),
        height=np.empty(capacity),
        following=np.empty(capacity, np.int32),
        edges=np.empty((capacity, DIRECTIONS), np.int32),
        found=np.zeros(1, np.int64),
    )


def _explore_all(world: World, lattice: Lattice, nodes: Nodes, leaps: Leaps) -> tuple[Nodes, Leaps]:
    """Find straight edges, diagonal edges and leaps from every node, until no new node is found."""
    body = Bodies(np.zeros((1, 3)), np.zeros(0, np.int32), 0)
    explored = np.zeros(3, np.int64)
    while explored[2] < nodes.found[0]:
        capacity = len(nodes.point)
        explore_further(Survey(world, NO_BODIES, lattice, nodes), body, leaps, explored)
        if nodes.found[0] + 2 * DIRECTIONS >= capacity:
            nodes = _with_capacity(nodes, capacity + capacity // 2)
        if leaps.found[0] + 2 * DIRECTIONS >= len(leaps.start):
            leaps = _with_more_leaps(leaps, 2 * len(leaps.start) + 64)
    return nodes, leaps


def _with_capacity(nodes: Nodes, capacity: int) -> Nodes:
    return nodes._replace(
        point=_longer(nodes.point, capacity),
        height=_longer(nodes.height, capacity),
        following=_longer(nodes.following, capacity),
        edges=_longer(nodes.edges, capacity),
    )


def _with_more_leaps(leaps: Leaps, capacity: int) -> Leaps:
    return Leaps(
        _longer(leaps.start, capacity),
        _longer(leaps.end, capacity),
        _longer(leaps.jump, capacity),
        leaps.found,
    )


def _longer(table: NDArray[Number], capacity: int) -> NDArray[Number]:
    longer = np.empty((capacity, *table.shape[1:]), table.dtype)
    longer[: len(table)] = table
    return longer


def _finish(world: World, lattice: Lattice, nodes: Nodes, leaps: Leaps) -> NavGraph:
    """Cut the tables to length and sort the leaps by their starts."""
    count, leap_count = int(nodes.found[0]), int(leaps.found[0])
    nodes = nodes._replace(
        point=nodes.point[:count],
        height=nodes.height[:count],
        following=nodes.following[:count],
        edges=nodes.edges[:count],
    )
    order = np.argsort(leaps.start[:leap_count], kind="stable")
    leap_start = np.zeros(count + 1, np.int64)
    np.cumsum(np.bincount(leaps.start[:leap_count], minlength=count), out=leap_start[1:])
    end, jump = leaps.end[:leap_count][order], leaps.jump[:leap_count][order]
    return NavGraph(world, lattice, nodes, leap_start, end, jump)
