"""Straight lines over the walkable graph: the nodes along a line, if a body can walk it.

A line follows the edges nearest to it. It counts as free where the edges on both sides of it can be walked; a
walk with the engine's motion decides finally (``search.pull_straight``).
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
    """Return the number of edges on the straight line from a node to another; 0 if it is not free.

    Args:
        along: (M,) the nodes after the start up to the end, written up to its size.
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
