"""Searching a map: square after square of it, each teammate from another one on."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.simulation.robots.base import Memory, Situation
from wildscav_engine.simulation.robots.obstacles import feel_way_to, forget_obstacle

SIDE = 30.0  # m, greatest side of a square; a target is seen from 20 m by default
NEAR = 10.0  # m from the middle of a square within which it has been searched
MAX_STEPS = 200.0  # on the way to a square
MAX_DETOURS = 3.0  # around one obstacle on that way


class Search(IntEnum):
    """Where a searching robot keeps its numbers in its memory: in places not needed otherwise."""

    SQUARE = Memory.FETCHING  # the number of the square that it goes to, from 1; 0 before the first one
    LEFT = Memory.DISTRACTED_LEFT  # steps for which it still goes there
    AWAY_LEFT = Memory.HIDE_LEFT  # steps for which it still wanders away from an obstacle


@kernel
def search(now: Situation, action: NDArray[np.float32]) -> None:
    """Walk to the middle of one square after another, row by row and back."""
    memory, here, water = now.agents.memory[now.seat], now.agents.position[now.seat], now.world.water
    rows, columns = int(np.ceil(water.shape[0] * CELL / SIDE)), int(np.ceil(water.shape[1] * CELL / SIDE))
    if memory[Search.SQUARE] == 0.0:
        _set_out(memory, _first_square(now, rows * columns))
    x, z = _middle(now, int(memory[Search.SQUARE]) - 1, rows, columns)
    dx, dz = x - here[0], z - here[2]
    memory[Search.LEFT] -= 1.0
    is_there = dx * dx + dz * dz < NEAR * NEAR
    if is_there or memory[Search.LEFT] <= 0.0 or memory[Memory.DETOURS] > MAX_DETOURS:
        _set_out(memory, int(memory[Search.SQUARE]) % (rows * columns))
        x, z = _middle(now, int(memory[Search.SQUARE]) - 1, rows, columns)
    feel_way_to(now, x, z, action)


@kernel
def stop_search(now: Situation) -> None:
    """Forget the search, if there was one, and what was on its way."""
    memory = now.agents.memory[now.seat]
    if memory[Search.SQUARE] > 0.0:
        memory[Search.SQUARE] = 0.0
        forget_obstacle(memory)


@kernel
def _set_out(memory: NDArray[np.float64], square: int) -> None:
    """Set out for a square, numbered from 0."""
    memory[Search.SQUARE], memory[Search.LEFT] = square + 1.0, MAX_STEPS
    forget_obstacle(memory)


@kernel
def _middle(now: Situation, square: int, rows: int, columns: int) -> tuple[float, float]:
    """Return x and z of the middle of a square; each row begins where the one before ended."""
    row, column = square // columns, square % columns
    if row % 2 == 1:
        column = columns - 1 - column
    corner, water = now.world.corner, now.world.water
    x = corner[0] + (column + 0.5) * water.shape[1] * CELL / columns
    z = corner[1] + (row + 0.5) * water.shape[0] * CELL / rows
    return float(x), float(z)


@kernel
def _first_square(now: Situation, squares: int) -> int:
    """Return the square in which a robot begins: teammates share the map evenly."""
    mates, before, agents = 0, 0, now.agents
    for seat in range(agents.health.shape[0]):
        if agents.present[seat] and agents.team[seat] == agents.team[now.seat]:
            mates += 1
            before += 1 if seat < now.seat else 0
    return before * squares // mates
