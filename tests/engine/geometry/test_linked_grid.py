"""Lists of what lies in each square of a grid."""

import numpy as np
import pytest
from tests.builders import flat_world

from wildscav_engine.geometry.linked_grid import (
    Range,
    Squares,
    column_of,
    columns_along,
    link,
    row_of,
    square_of,
    squares_around,
    squares_over,
    unlink,
)

# 8 by 8 squares of 5 m, from (-20, -20) to (20, 20).
GRID: Squares = squares_over(flat_world(40), 8)


def test_a_grid_covers_the_map() -> None:
    assert Squares(-20.0, -20.0, 5.0, 5.0, 0.2, 0.2, 8) == GRID


@pytest.mark.parametrize(
    ("x", "z", "column", "row"),
    [
        (-20.0, -20.0, 0, 0),
        (-15.1, -14.9, 0, 1),
        (0.0, 4.9, 4, 4),
        (19.9, 19.9, 7, 7),
        (20.0, 50.0, 7, 7),  # the edge and what lies beyond it belong to the outermost squares
        (-50.0, -20.1, 0, 0),
    ],
)
def test_a_place_lies_in_one_square(x: float, z: float, column: int, row: int) -> None:
    assert (column_of(GRID, x), row_of(GRID, z)) == (column, row)
    assert square_of(GRID, x, z) == row * 8 + column


def test_squares_around_a_place_hold_all_that_is_near() -> None:
    assert squares_around(GRID, 0.0, -20.0, 4.0) == Range(west=3, east=4, south=0, north=0)
    assert squares_around(GRID, 2.0, 12.0, 6.0) == Range(west=3, east=5, south=5, north=7)


@pytest.mark.parametrize(
    ("row", "way", "reach", "columns"),
    [
        (4, (-12.0, 2.0, 20.0, 0.0), 0.0, (1, 5)),  # eastwards, within the row
        (4, (8.0, 2.0, -20.0, 0.0), 0.0, (1, 5)),  # and back
        (4, (-12.0, 2.0, 20.0, 0.0), 4.0, (0, 6)),
        (5, (-20.0, -20.0, 40.0, 40.0), 0.0, (5, 6)),  # from corner to corner: x and z are the same
        (5, (-20.0, -20.0, 40.0, 40.0), 1.0, (4, 6)),  # x from 5 - 1 - 1 to 10 + 1 + 1
        (3, (11.0, -20.0, 0.0, 40.0), 0.0, (6, 6)),  # straight northwards
    ],
)
def test_of_a_row_only_columns_near_the_way_are_told(
    row: int, way: tuple[float, float, float, float], reach: float, columns: tuple[int, int]
) -> None:
    assert columns_along(GRID, row, *way, reach) == columns


def test_no_place_near_a_way_is_missed() -> None:
    dice = np.random.default_rng(3)
    for x, z, dx, dz, reach in dice.uniform((-24, -24, -48, -48, 0), (24, 24, 48, 48, 3), (60, 5)):
        for share, off_x, off_z in dice.uniform((0, -1, -1), (1, 1, 1), (30, 3)):
            place_x, place_z = x + share * dx + off_x * reach, z + share * dz + off_z * reach
            west, east = columns_along(GRID, row_of(GRID, place_z), x, z, dx, dz, reach)
            assert west <= column_of(GRID, place_x) <= east


def listed(heads: np.ndarray, links: np.ndarray, square: int) -> list[int]:
    """The items of a square, in the order of its list."""
    items, following = [], heads[square]
    while following != 0:
        items.append(int(following) - 1)
        following = links[following - 1]
    return items


def test_items_come_and_go_from_either_end_and_from_the_middle() -> None:
    heads, links = np.zeros(4, np.int32), np.zeros(6, np.int32)
    for item in (0, 3, 5, 1):
        link(heads, links, 2, item)
    link(heads, links, 0, 4)
    assert listed(heads, links, 2) == [1, 5, 3, 0]
    assert listed(heads, links, 0) == [4]

    unlink(heads, links, 2, 5)  # from the middle
    assert listed(heads, links, 2) == [1, 3, 0]
    unlink(heads, links, 2, 0)  # the last
    unlink(heads, links, 2, 1)  # the first
    unlink(heads, links, 2, 4)  # one that is in another square
    assert listed(heads, links, 2) == [3]
    unlink(heads, links, 2, 3)
    assert listed(heads, links, 2) == []
    assert listed(heads, links, 0) == [4]
