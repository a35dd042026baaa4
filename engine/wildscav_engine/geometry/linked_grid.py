"""A uniform grid of squares over a map, with a linked list of the items in each square.

It finds agents and supply boxes near a place, along a path or from near to far without testing all of them.
Heads and links of a list hold item numbers plus 1, and 0 ends a list, so arrays of zeros are empty lists.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import CELL, World


class Squares(NamedTuple):
    """The layout of a grid of squares."""

    west: float  # m, of the south-western square's corner
    south: float  # m
    width: float  # m, of each square from west to east
    depth: float  # m, from south to north
    per_x: float  # squares per metre eastwards
    per_z: float  # and northwards
    side: int  # squares along each side of the map


class Range(NamedTuple):
    """The squares that an axis-aligned rectangle touches, the last row and column included."""

    west: int  # columns
    east: int
    south: int  # rows
    north: int


@inlined_kernel
def squares_over(world: World, side: int) -> Squares:
    """Return a grid of ``side`` by ``side`` squares over a map."""
    rows, columns = world.water.shape
    width, depth = columns * CELL / side, rows * CELL / side
    return Squares(world.corner[0], world.corner[1], width, depth, 1.0 / width, 1.0 / depth, side)


@inlined_kernel
def column_of(squares: Squares, x: float) -> int:
    """Return the column of a place; outside the map, the nearest one."""
    return min(squares.side - 1, max(0, int((x - squares.west) * squares.per_x)))


@inlined_kernel
def row_of(squares: Squares, z: float) -> int:
    """Return the row of a place; outside the map, the nearest one."""
    return min(squares.side - 1, max(0, int((z - squares.south) * squares.per_z)))


@inlined_kernel
def square_of(squares: Squares, x: float, z: float) -> int:
    """Return the square that a place lies in."""
    return row_of(squares, z) * squares.side + column_of(squares, x)


@inlined_kernel
def squares_around(squares: Squares, x: float, z: float, reach: float) -> Range:
    """Return the squares that hold all places up to ``reach`` m away in x and z."""
    return Range(
        column_of(squares, x - reach),
        column_of(squares, x + reach),
        row_of(squares, z - reach),
        row_of(squares, z + reach),
    )


@kernel
def columns_along(
    squares: Squares, row: int, x: float, z: float, dx: float, dz: float, reach: float
) -> tuple[int, int]:
    """Return the first and last column of a row whose squares hold places up to ``reach`` m from a segment.

    Args:
        row: Row of squares.
        x: m, where the segment starts; so z.
        dx: m, from its start to its end; so dz.
        reach: m, in x and z.
    """
    enter, leave = 0.0, 1.0
    if dz != 0.0:
        # The outermost rows also hold what lies outside the map.
        low = squares.south + row * squares.depth - reach if row > 0 else -np.inf
        high = squares.south + (row + 1) * squares.depth + reach if row < squares.side - 1 else np.inf
        first, last = (low - z) / dz, (high - z) / dz
        enter, leave = max(enter, min(first, last)), min(leave, max(first, last))
    start, end = x + dx * enter, x + dx * leave
    return column_of(squares, min(start, end) - reach), column_of(squares, max(start, end) + reach)


@inlined_kernel
def link(heads: NDArray[np.int32], links: NDArray[np.int32], square: int, item: int) -> None:
    """Insert an item at the head of a square's list."""
    links[item] = heads[square]
    heads[square] = item + 1


@kernel
def unlink(heads: NDArray[np.int32], links: NDArray[np.int32], square: int, item: int) -> None:
    """Remove an item from a square's list, if it is there."""
    if heads[square] == item + 1:
        heads[square] = links[item]
        return
    before = heads[square]
    while before != 0:
        if links[before - 1] == item + 1:
            links[before - 1] = links[item]
            return
        before = links[before - 1]
