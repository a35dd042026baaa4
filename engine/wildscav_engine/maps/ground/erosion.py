"""Erosion by rain and frost: gullies, valley floors, screes."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Stream, uniform
from wildscav_engine.compilation.kernel import kernel

STREAM = int(Stream.TERRAIN)
RAIN_KEY = 2  # the first of the frames that key the drops
LONGEST_RUN = 48  # cells that a drop runs through at most
INERTIA = 0.25  # share of its direction that a drop keeps in each cell
CAPACITY = 5.0  # m of soil carried by slope, speed and water
LEAST_FALL = 0.02  # m per cell, so that drops carry some soil on level ground, too
TAKING, LEAVING = 0.25, 0.12  # shares of its spare capacity and of its excess that a drop takes up and leaves
DRYING = 0.03  # share of the water lost in each cell


@kernel
def rain(seed: np.uint64, number: int, drops: int, heights: NDArray[np.float64]) -> None:
    """Let drops run downhill one after another; they take up soil where they speed up and leave it below.

    Beyer, "Implementation of a Method for Hydraulic Erosion", TU München 2015, without its brush: callers
    smooth the change of the (R, C) heights in m instead.
    """
    rows, columns = heights.shape
    for drop in range(drops):
        x = uniform(seed, STREAM, RAIN_KEY + number, drop, 0) * (columns - 1.001)
        z = uniform(seed, STREAM, RAIN_KEY + number, drop, 1) * (rows - 1.001)
        _run(x, z, heights)


@kernel
def _run(x: float, z: float, heights: NDArray[np.float64]) -> None:
    """Simulate one drop from (x, z), in cells, until it is dry, at rest, or over the edge."""
    rows, columns = heights.shape
    dx, dz, speed, water, soil = 0.0, 0.0, 1.0, 1.0, 0.0
    for _ in range(LONGEST_RUN):
        column, row = int(x), int(z)
        east, north = x - column, z - row
        h00, h01 = heights[row, column], heights[row, column + 1]
        h10, h11 = heights[row + 1, column], heights[row + 1, column + 1]
        here = (h00 * (1.0 - east) + h01 * east) * (1.0 - north) + (h10 * (1.0 - east) + h11 * east) * north
        up_x = (h01 - h00) * (1.0 - north) + (h11 - h10) * north
        up_z = (h10 - h00) * (1.0 - east) + (h11 - h01) * east
        dx = dx * INERTIA - up_x * (1.0 - INERTIA)
        dz = dz * INERTIA - up_z * (1.0 - INERTIA)
        length = np.sqrt(dx * dx + dz * dz)
        if length < 1e-9:
            return
        dx, dz = dx / length, dz / length
        x, z = x + dx, z + dz
        if not (0.0 <= x < columns - 1 and 0.0 <= z < rows - 1):
            return
        fall = here - _height_at(x, z, heights)
        capacity = max(fall, LEAST_FALL) * speed * water * CAPACITY
        if fall < 0.0:
            moved = min(-fall, soil)  # fills the hollow behind it
        elif soil > capacity:
            moved = (soil - capacity) * LEAVING
        else:
            moved = -min((capacity - soil) * TAKING, fall)
        soil -= moved
        heights[row, column] += moved * (1.0 - east) * (1.0 - north)
        heights[row, column + 1] += moved * east * (1.0 - north)
        heights[row + 1, column] += moved * (1.0 - east) * north
        heights[row + 1, column + 1] += moved * east * north
        speed = np.sqrt(max(0.0, speed * speed * 0.9 + fall))
        water *= 1.0 - DRYING


@kernel
def add_finely(coarseness: int, change: NDArray[np.float64], heights: NDArray[np.float64]) -> None:
    """Add a change of coarse ground in m to fine ground, (R, C) m, with bilinear interpolation.

    There are ``coarseness`` points of the fine ground per point of the coarse one, along each side.
    """
    last_row, last_column = change.shape[0] - 1.001, change.shape[1] - 1.001
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            x, z = min(column / coarseness, last_column), min(row / coarseness, last_row)
            heights[row, column] += _height_at(x, z, change)


@kernel
def _height_at(x: float, z: float, heights: NDArray[np.float64]) -> float:
    column, row = int(x), int(z)
    east, north = x - column, z - row
    south = heights[row, column] * (1.0 - east) + heights[row, column + 1] * east
    above = heights[row + 1, column] * (1.0 - east) + heights[row + 1, column + 1] * east
    return float(south * (1.0 - north) + above * north)


@kernel
def crumble(steepest: float, cliffs: NDArray[np.float64], rounds: int, heights: NDArray[np.float64]) -> None:
    """Let soil that is too steep slide down, half of the excess each round, except on rock.

    Without rock, neighbours may differ by ``steepest`` m. Cliffs, (R, C) from 0 to 1, say how rocky the
    ground is.
    """
    rows, columns = heights.shape
    for _ in range(rounds):
        for row in range(rows):
            for column in range(columns):
                holds = steepest * (1.0 + 6.0 * max(0.0, cliffs[row, column] - 0.35))
                if column + 1 < columns:
                    _slide(row, column, row, column + 1, holds, heights)
                if row + 1 < rows:
                    _slide(row, column, row + 1, column, holds, heights)


@kernel
def _slide(
    row: int, column: int, row_2: int, column_2: int, holds: float, heights: NDArray[np.float64]
) -> None:
    fall = heights[row, column] - heights[row_2, column_2]
    excess = abs(fall) - holds
    if excess > 0.0:
        moved = 0.25 * excess if fall > 0.0 else -0.25 * excess
        heights[row, column] -= moved
        heights[row_2, column_2] += moved
