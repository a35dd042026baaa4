"""Straight lines over the walkable graph: which nodes lie along one, if nothing keeps a body off it.

A line runs along the edges nearest to it. It counts as free where the edges to both of its sides can be
walked; a walk by the engine's motion has the last word (``search.pull_straight``).
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.maps.walk.lattice import SPACING

ON_LINE = 1e-9  # m


@kernel
def follow_line(
    places: NDArray[np.float64],
    edges: NDArray[np.int32],
    start: int,
    end: int,
    along: NDArray[np.int32],
) -> int:
    """Return how many edges lead straight from a node to another; 0 if the line is not free.

    Args:
        places: (N, 3) m, of the nodes.
        edges: (N, 8) nodes, negative for none.
        start: Node.
        end: Another one.
        along: (M,) the nodes behind the start up to the end, written as far as there is room.
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
    """Return the straight and the diagonal direction (of ``lattice.DIRECTIONS``) that a way lies between."""
    across, along = 0 if east > 0.0 else 4, 2 if north > 0.0 else 6
    straight = across if abs(east) >= abs(north) else along
    if east > 0.0:
        return straight, 1 if north > 0.0 else 7
    return straight, 3 if north > 0.0 else 5


@kernel
def _off_line(places: NDArray[np.float64], start: int, end: int, node: int) -> float:
    """Return how far a node lies off a line, in m times the line's length."""
    east, north = places[end, 0] - places[start, 0], places[end, 2] - places[start, 2]
    to_east, to_north = places[node, 0] - places[start, 0], places[node, 2] - places[start, 2]
    return float(abs(east * to_north - north * to_east))
