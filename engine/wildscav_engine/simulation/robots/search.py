"""Searching a map, square after square of it, each teammate from another one on, and feeling one's way there.

A robot goes straight on, then jumps, then goes along an obstacle on either side. The rule is that of the
baseline ``homing``: detours around one obstacle get longer and change sides, until the target is nearer than
it was in front of the obstacle.
"""

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.simulation.robots.base import (
    PATIENCE,
    STUCK_SPEED,
    Memory,
    Situation,
    random_in,
    turn_toward,
)
from wildscav_engine.specs.actions import Field

SIDE = 30.0  # m, greatest side of a square; a target is seen from 20 m by default
NEAR = 10.0  # m from the middle of a square within which it has been searched
MAX_STEPS = 200.0  # on the way to a square
MAX_DETOURS = 3.0  # around one obstacle on that way
PROGRESS = 2.0  # m nearer to the target than before: the obstacle has been passed
FIRST_SIDE = 60.0  # degrees between the first detour and the straight way
SIDES = (70.0, 150.0)  # degrees, least and greatest of later ones
SHORTEST, LONGER, LONGEST = 8.0, 5.0, 60.0  # steps of a detour: the first, what each is longer, the most
JUMPS = 8.0  # steps from jump to jump on a detour, where a low step may be in the way


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


@kernel
def feel_way_to(now: Situation, x: float, z: float, action: NDArray[np.float32]) -> None:
    """Walk to a position, around what is in the way, looking ahead."""
    memory, here = now.agents.memory[now.seat], now.agents.position[now.seat]
    dx, dz = x - here[0], z - here[2]
    _notice_progress(memory, np.sqrt(dx * dx + dz * dz))
    _notice_obstacle(now, memory)
    heading, is_stuck = arctangent(dx, dz), memory[Memory.STUCK] > 0.0
    if memory[Memory.DETOUR_LEFT] > 0.0:
        memory[Memory.DETOUR_LEFT] -= 1.0
        heading += memory[Memory.DETOUR_SIDE]
        is_stuck = is_stuck or memory[Memory.DETOUR_LEFT] % JUMPS == 0.0
    action[Field.JUMP] = 1.0 if is_stuck else 0.0
    memory[Memory.WANTED_SPEED] = now.skill.speed
    action[Field.WALK_DIRECTION] = wrap(heading)
    action[Field.WALK_SPEED] = now.skill.speed
    turn_toward(now, heading, 0.0, now.skill.turn_limit, action)


@kernel
def forget_obstacle(memory: NDArray[np.float64]) -> None:
    """Begin a new way: nothing is known of what is on it."""
    memory[Memory.NEAREST], memory[Memory.DETOURS], memory[Memory.DETOUR_LEFT] = 0.0, 0.0, 0.0


@kernel
def _notice_progress(memory: NDArray[np.float64], left: float) -> None:
    """Forget the current obstacle if the target is nearer than it was in front of it."""
    if memory[Memory.NEAREST] == 0.0 or left < memory[Memory.NEAREST] - PROGRESS:
        memory[Memory.NEAREST], memory[Memory.DETOURS] = left, 0.0


@kernel
def _notice_obstacle(now: Situation, memory: NDArray[np.float64]) -> None:
    """Count the steps without progress, and after some begin the next detour."""
    velocity = now.agents.velocity[now.seat]
    pace = np.sqrt(velocity[0] * velocity[0] + velocity[2] * velocity[2])
    memory[Memory.STUCK] = (
        memory[Memory.STUCK] + 1.0 if pace < STUCK_SPEED * memory[Memory.WANTED_SPEED] else 0.0
    )
    if memory[Memory.STUCK] <= PATIENCE:
        return
    detours, side = memory[Memory.DETOURS], memory[Memory.DETOUR_SIDE]
    if detours == 0.0:
        side = FIRST_SIDE if random_in(now, -1.0, 1.0, 7) < 0.0 else -FIRST_SIDE
    elif detours % 3.0 == 2.0:
        side = -side
    else:
        side = math.copysign(random_in(now, SIDES[0], SIDES[1], 8), side)
    memory[Memory.STUCK], memory[Memory.DETOUR_SIDE], memory[Memory.DETOURS] = 0.0, side, detours + 1.0
    memory[Memory.DETOUR_LEFT] = min(SHORTEST + LONGER * detours, LONGEST)
