"""Connected components of a map's cells or points: removing small ones, and the size of the largest."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel


@kernel
def flip_small_components(
    value: int, least: float, queue: NDArray[np.int32], cells: NDArray[np.int8]
) -> None:
    """Flip connected components of a value to the other value if they are too small.

    Args:
        value: 0 or 1.
        least: Cells of the smallest component that stays.
        queue: (R * C,) scratch buffer.
        cells: (R, C) zeros and ones, changed.
    """
    columns = cells.shape[1]
    for start in range(cells.size):
        if cells[start // columns, start % columns] == value:
            found = _mark_component(value, start, queue, cells)
            if found < least:
                for part in range(found):
                    cells[queue[part] // columns, queue[part] % columns] = 1 - value
    for row in range(cells.shape[0]):
        for column in range(columns):
            if cells[row, column] == value + 2:
                cells[row, column] = value


@kernel
def largest_component(queue: NDArray[np.int32], cells: NDArray[np.int8]) -> int:
    """Return the size in cells of the largest connected component of ones; afterwards all ones are threes."""
    most = 0
    for start in range(cells.size):
        if cells[start // cells.shape[1], start % cells.shape[1]] == 1:
            most = max(most, _mark_component(1, start, queue, cells))
    return most


@kernel
def _mark_component(value: int, start: int, queue: NDArray[np.int32], cells: NDArray[np.int8]) -> int:
    """Add 2 to the cells of a cell's component, list them in ``queue``, and return their number."""
    rows, columns = cells.shape
    queue[0], found, done = start, 1, 0
    cells[start // columns, start % columns] = value + 2
    while done < found:
        row, column = queue[done] // columns, queue[done] % columns
        done += 1
        for side in range(4):
            r, c = row + (side == 0) - (side == 1), column + (side == 2) - (side == 3)
            if 0 <= r < rows and 0 <= c < columns and cells[r, c] == value:
                cells[r, c] = value + 2
                queue[found] = r * columns + c
                found += 1
    return found
