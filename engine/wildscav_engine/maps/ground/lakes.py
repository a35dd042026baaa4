"""Lakes: where water stands, how deep it is, and the shores around it; connected components of cells."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import CELL

DEEPEST_WATER = 1.2  # m; agents wade, and their eyes stay above the surface
SHELF = 4.5  # m from the shore to where a lake has half its depth
SMALLEST_LAKE = 40.0  # m²
SMALLEST_SHARE = 0.006  # of all water in one lake; smaller ponds are filled in
SHORE_ROUNDS = 3  # of smoothing, which rounds off the corners of a shore
LEAST_LEFT = 0.75  # of the smallest lake, after the smoothing
ROUNDS = 14  # of bisection for the water's level
DIAGONAL = 1.4142135623730951
FAR = 1e6  # m, more than any distance on a map


def flood(
    heights: NDArray[np.float64], bumps: NDArray[np.float64], water: float, scale: float
) -> NDArray[np.float64]:
    """Fill the hollows of (R, C) m with water, and return the heights above its surface, times ``scale``.

    A share of the points, ``water``, is to be under water. The bumps, (R, C) m, are added to the heights when
    deciding where it stands, which bends the shores.
    """
    smooth = heights.copy()
    for _ in range(3):
        smooth = softened(smooth)
    smooth += bumps
    level = _level_of(smooth, water)
    wet = _lakes_at(level, smooth, water)
    above = (heights - level) * scale
    # Padded, so that every point has neighbours.
    from_water, from_land = (np.full((len(wet) + 2, wet.shape[1] + 2), FAR) for _ in range(2))
    _measure(1, wet, from_water)
    _measure(0, wet, from_land)
    # A shore runs between the points: half a cell from the last wet one, and in curves around corners.
    from_shore = np.where(wet == 1, 0.5 * CELL - from_land[1:-1, 1:-1], from_water[1:-1, 1:-1] - 0.5 * CELL)
    for _ in range(SHORE_ROUNDS):
        from_shore = softened(from_shore)
    wet = (from_shore < 0.0).astype(np.int8)
    flip_small_components(1, LEAST_LEFT * _least_points(water, wet.size), wet)
    _shape_shores(np.where(wet == 1, from_shore, np.abs(from_shore)), above)
    return above


def softened(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (R, C) heights smoothed with a 3 × 3 kernel."""
    wide = np.pad(heights, 1, mode="edge")
    lines = (wide[:-2] + 2.0 * wide[1:-1] + wide[2:]) * 0.25
    return np.asarray((lines[:, :-2] + 2.0 * lines[:, 1:-1] + lines[:, 2:]) * 0.25)


def _level_of(smooth: NDArray[np.float64], water: float) -> float:
    """Return the level in m at which the lakes that are large enough cover the wanted share."""
    low, high = float(smooth.min()), float(smooth.max())
    best, least_miss = low, 2.0
    for _ in range(ROUNDS):
        level = 0.5 * (low + high)
        share = int(np.count_nonzero(_lakes_at(level, smooth, water))) / smooth.size
        if abs(share - water) < least_miss:
            best, least_miss = level, abs(share - water)
        low, high = (level, high) if share < water else (low, level)
    return best


def _lakes_at(level: float, smooth: NDArray[np.float64], water: float) -> NDArray[np.int8]:
    """Return (R, C) 1 for water at a level, without small ponds and islands, else 0."""
    wet = (smooth < level).astype(np.int8)
    least = _least_points(water, smooth.size)
    flip_small_components(1, least, wet)
    flip_small_components(0, least, wet)
    return wet


def _least_points(water: float, points: int) -> float:
    """Return the number of points of the smallest lake that a map may have."""
    return max(SMALLEST_LAKE / (CELL * CELL), SMALLEST_SHARE * water * points)


@kernel
def _measure(value: int, wet: NDArray[np.int8], away: NDArray[np.float64]) -> None:
    """Write how far, in m within a few percent, each point is from the nearest one with a value, 0 or 1.

    Borgefors, "Distance Transformations in Digital Images", 1986: two passes over neighbours. At first,
    ``away``, (R + 2, C + 2), is FAR everywhere; its border stays.
    """
    rows, columns = wet.shape
    for row in range(rows):
        for column in range(columns):
            if wet[row, column] == value:
                away[row + 1, column + 1] = 0.0
    for row in range(1, rows + 1):
        for column in range(1, columns + 1):
            beside = min(away[row, column - 1], away[row - 1, column]) + CELL
            across = min(away[row - 1, column - 1], away[row - 1, column + 1]) + CELL * DIAGONAL
            away[row, column] = min(away[row, column], beside, across)
    for row in range(rows, 0, -1):
        for column in range(columns, 0, -1):
            beside = min(away[row, column + 1], away[row + 1, column]) + CELL
            across = min(away[row + 1, column + 1], away[row + 1, column - 1]) + CELL * DIAGONAL
            away[row, column] = min(away[row, column], beside, across)


@kernel
def _shape_shores(from_shore: NDArray[np.float64], above: NDArray[np.float64]) -> None:
    """Make beds shallow and shores gentle, and lift land that is too low into dry flats.

    Both are (R, C) m: to the nearest shore, negative in a lake; and above the water's level, changed.
    """
    for row in range(above.shape[0]):
        for column in range(above.shape[1]):
            away = from_shore[row, column]
            if away < 0.0:
                above[row, column] = DEEPEST_WATER * away / (SHELF - away)
            else:
                bank = min(away, 1.0)
                beach = 0.1 * bank + 0.1 * away + 0.025 * away * away
                flats = min(0.1 * bank + 0.03 * away, 0.6)
                height = smooth_least(above[row, column], beach, min(beach, 1.0))
                above[row, column] = -smooth_least(-height, -flats, 0.3 * bank)


@kernel
def smooth_least(one: float, other: float, width: float) -> float:
    """Return a smooth minimum: the lesser of two, slightly less where they differ by less than ``width``.

    Two slopes join without an edge, and the join is nowhere steeper than both. Quilez, "Smooth minimum".
    """
    near = max(width - abs(one - other), 0.0)
    return min(one, other) - near * near / (4.0 * width) if width > 0.0 else min(one, other)


@array_kernel
def flip_small_components(value: int, least: float, cells: NDArray[np.int8]) -> None:
    """Flip the connected components of a value, 0 or 1, that have fewer than ``least`` cells."""
    queue, columns = np.empty(cells.size, np.int32), cells.shape[1]
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


@array_kernel
def largest_component(cells: NDArray[np.int8]) -> int:
    """Return the size in cells of the largest connected component of ones; afterwards all ones are threes."""
    queue, most = np.empty(cells.size, np.int32), 0
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
