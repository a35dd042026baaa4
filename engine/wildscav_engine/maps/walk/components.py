"""The strongly connected components of the walkable graph."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.maps.walk.lattice import DIRECTIONS


@kernel
def successor(
    node: int,
    number: int,
    edges: NDArray[np.int32],
    leap_start: NDArray[np.int64],
    leap_end: NDArray[np.int32],
) -> int:
    """Return the node that the edge or leap of a number leads to; -1 for none, -2 past the last."""
    if number < DIRECTIONS:
        return max(-1, int(edges[node, number]))
    leap = leap_start[node] + number - DIRECTIONS
    return int(leap_end[leap]) if leap < leap_start[node + 1] else -2


@array_kernel
def strong_components(
    edges: NDArray[np.int32], leap_start: NDArray[np.int64], leap_end: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return (N,) the number of the strongly connected component of every node.

    Tarjan, "Depth-First Search and Linear Graph Algorithms", SIAM J. Comput. 1 (1972), with an explicit stack
    instead of recursion.
    """
    count = edges.shape[0]
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
            other = successor(node, following[node], edges, leap_start, leap_end)
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
