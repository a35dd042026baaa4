"""Connected parts of a map's cells or points: the small ones, and how much the largest takes up."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel


@kernel
def turn_small_parts(value: int, least: float, waiting: NDArray[np.int32], cells: NDArray[np.int8]) -> None:
    """Turn connected parts of a value into the other one where they are too small.

    Args:
        value: 0 or 1.
        least: Cells of the smallest part that stays.
        waiting: (R * C,) room for the search.
        cells: (R, C) zeros and ones, changed.
    """
    columns = cells.shape[1]
    for start in range(cells.size):
        if cells[start // columns, start % columns] == value:
            found = _mark_part(value, start, waiting, cells)
            if found < least:
                for part in range(found):
                    cells[waiting[part] // columns, waiting[part] % columns] = 1 - value
    for row in range(cells.shape[0]):
        for column in range(columns):
            if cells[row, column] == value + 2:
                cells[row, column] = value


@kernel
def largest_part(waiting: NDArray[np.int32], cells: NDArray[np.int8]) -> int:
    """Return how many cells the largest connected part of ones has; all ones are threes after."""
    most = 0
    for start in range(cells.size):
        if cells[start // cells.shape[1], start % cells.shape[1]] == 1:
            most = max(most, _mark_part(1, start, waiting, cells))
    return most


@kernel
def _mark_part(value: int, start: int, waiting: NDArray[np.int32], cells: NDArray[np.int8]) -> int:
    """Add 2 to the part of a value that a cell is in, list it in ``waiting``, and return its size."""
    rows, columns = cells.shape
    waiting[0], found, done = start, 1, 0
    cells[start // columns, start % columns] = value + 2
    while done < found:
        row, column = waiting[done] // columns, waiting[done] % columns
        done += 1
        for side in range(4):
            r, c = row + (side == 0) - (side == 1), column + (side == 2) - (side == 3)
            if 0 <= r < rows and 0 <= c < columns and cells[r, c] == value:
                cells[r, c] = value + 2
                waiting[found] = r * columns + c
                found += 1
    return found
