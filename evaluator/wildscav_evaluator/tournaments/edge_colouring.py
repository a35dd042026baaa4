"""Colours for the edges of a bipartite graph, with as few colours as its busiest node has edges.

D. König, "Über Graphen und ihre Anwendung auf Determinantentheorie und Mengenlehre", 1916.
"""

from itertools import cycle

import numpy as np
from numpy.typing import NDArray

Int = NDArray[np.int64]

NONE = -1


def colour_edges(left: Int, right: Int, colours: int) -> Int:
    """Return a colour for each edge (E,), so that no two edges of a node have the same.

    Args:
        left: (E,) the node at one end of each edge.
        right: (E,) the node at the other, numbered separately.
        colours: At least the number of edges of any node.
    """
    graph = _Graph(left, right, colours)
    for edge in range(len(left)):
        graph.colour(edge)
    return np.array(graph.colours, np.int64)


class _Graph:
    """A graph whose edges get their colours one after the other.

    The nodes of both sides are numbered together here, in one list, which holds the edge of each colour.
    """

    def __init__(self, left: Int, right: Int, colours: int) -> None:
        offset = int(left.max()) + 1
        nodes = offset + int(right.max()) + 1
        self.ends = list(zip(left.tolist(), (right + offset).tolist(), strict=True))
        self.edges = [[NONE] * colours for _ in range(nodes)]
        self.free = [(1 << colours) - 1] * nodes  # a bit for each colour that no edge of the node has
        self.colours = [NONE] * len(left)

    def colour(self, edge: int) -> None:
        """Give an edge a colour that is free at both ends; if there is none, make one free."""
        here, there = self.ends[edge]
        both = self.free[here] & self.free[there]
        if not both:
            both = self.free[here] & -self.free[here]
            self._make_free(there, _lowest(both), _lowest(self.free[there]))
        colour = _lowest(both)
        self._paint(edge, colour)
        self.free[here] ^= 1 << colour
        self.free[there] ^= 1 << colour

    def _make_free(self, node: int, wanted: int, spare: int) -> None:
        """Exchange two colours on the path from a node along edges of these colours in turn."""
        path, last = [], node
        for colour in cycle((wanted, spare)):
            edge = self.edges[last][colour]
            if edge == NONE:
                break
            path.append(edge)
            here, there = self.ends[edge]
            last = there if last == here else here
        for edge in path:
            here, there = self.ends[edge]
            self.edges[here][self.colours[edge]] = self.edges[there][self.colours[edge]] = NONE
        for edge in path:
            self._paint(edge, spare if self.colours[edge] == wanted else wanted)
        for end in (node, last):
            self.free[end] ^= 1 << wanted | 1 << spare

    def _paint(self, edge: int, colour: int) -> None:
        here, there = self.ends[edge]
        self.edges[here][colour] = self.edges[there][colour] = edge
        self.colours[edge] = colour


def _lowest(bits: int) -> int:
    """Return the number of the lowest bit that is set."""
    return (bits & -bits).bit_length() - 1
