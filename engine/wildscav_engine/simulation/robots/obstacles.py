"""Feeling one's way to a target: straight on, then jumping, then along the obstacle on either side.

The rule is that of the baseline ``homing``: detours around one obstacle get longer and change sides, until
the target is nearer than it was in front of the obstacle.
"""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import (
    PATIENCE,
    STUCK_SPEED,
    Memory,
    Situation,
    random_in,
    turn_toward,
)
from wildscav_engine.specs.actions import Field

PROGRESS = 2.0  # m nearer to the target than before: the obstacle has been passed
FIRST_SIDE = 60.0  # degrees between the first detour and the straight way
SIDES = (70.0, 150.0)  # degrees, least and greatest of later ones
SHORTEST, LONGER, LONGEST = 8.0, 5.0, 60.0  # steps of a detour: the first, what each is longer, the most
JUMPS = 8.0  # steps from jump to jump on a detour, where a low step may be in the way


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
