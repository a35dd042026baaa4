"""The fighter: it shoots at the nearest enemy in sight, and otherwise gathers supplies.

The hard one runs for cover while it reloads and when it is weak, and stays hidden for a moment. It knows what
is around it as a body with eyes does: rays tell whether a place a few steps away can be walked to and is
hidden from the enemy.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.simulation.robots.aiming import aim_and_fire, circle, nearest_enemy, reload_low_clip
from wildscav_engine.simulation.robots.base import (
    Memory,
    Situation,
    gather,
    keep_safe,
    levels_of,
    turn_toward,
    visit_hot_spot,
    walk_toward,
    wander,
)
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import EYE_HEIGHT

COVER_DISTANCE = 6.0  # m to the places that it considers
COVER_PLACES = 7  # from straight away from the enemy to both sides
COVER_STEP = 30.0  # degrees between their directions
CHEST = 1.0  # m above the soles, what cover must hide
HIDING = 15.0  # steps for which it hides after it last saw the enemy
RUNNING = 10.0  # the last steps of those, in which it stands still


@kernel
def fight(now: Situation, action: NDArray[np.float32]) -> None:
    """Fight the nearest enemy in sight; else reload, and keep safe, gather, visit the hot spot or wander."""
    enemy = nearest_enemy(now)
    if enemy == NOBODY:
        reload_low_clip(now, action)
        if keep_safe(now, action) or hide(now, action) or gather(now, action) or visit_hot_spot(now, action):
            return
        wander(now, action)
        return
    yaw = aim_and_fire(now, enemy, action)
    if leaves_fight(now, enemy):
        take_cover(now, enemy, action)
    else:
        circle(now, enemy, yaw, action)
    action[Field.PICK_UP] = 1.0


@kernel
def leaves_fight(now: Situation, enemy: int) -> bool:
    """Return whether a robot would rather not fight an enemy now."""
    agents, seat = now.agents, now.seat
    if now.skill.caution == 0.0:
        return False
    if agents.reload_left[seat] > 0 or agents.clip[seat] == 0:
        return True
    is_hurt = agents.health[seat] <= now.skill.caution * agents.full_health[seat]
    return bool(is_hurt and agents.health[seat] < agents.health[enemy])


@kernel
def take_cover(now: Situation, enemy: int, action: NDArray[np.float32]) -> None:
    """Run to a place nearby that is hidden from an enemy, or away from it; the view stays as it is."""
    memory = now.agents.memory[now.seat]
    heading = _cover_heading(now, enemy)
    memory[Memory.HIDE_LEFT], memory[Memory.HEADING] = HIDING, heading
    walk_toward(now, heading, now.skill.speed, action)


@kernel
def hide(now: Situation, action: NDArray[np.float32]) -> bool:
    """Run on into cover and wait there, reloading and looking back; return False if it does not hide."""
    memory = now.agents.memory[now.seat]
    if memory[Memory.HIDE_LEFT] <= 0.0:
        return False
    memory[Memory.HIDE_LEFT] -= 1.0
    action[Field.RELOAD] = 1.0
    if memory[Memory.HIDE_LEFT] >= RUNNING:
        walk_toward(now, memory[Memory.HEADING], now.skill.speed, action)
    turn_toward(now, memory[Memory.HEADING] + 180.0, 0.0, now.skill.turn_limit, action)
    return True


@kernel
def _cover_heading(now: Situation, enemy: int) -> float:
    """Return the compass direction of the cover that is most away from an enemy, or else away from it."""
    here, there = now.agents.position[now.seat], now.agents.position[enemy]
    away = arctangent(here[0] - there[0], here[2] - there[2])
    for place in range(COVER_PLACES):
        side = COVER_STEP * ((place + 1) // 2)
        heading = away + (side if place % 2 == 0 else -side)
        x, z = here[0] + COVER_DISTANCE * sine(heading), here[2] + COVER_DISTANCE * cosine(heading)
        chest = here[1] + CHEST
        can_go = sight_is_clear(now.world, here[0], chest, here[2], x, chest, z)
        if can_go and not sight_is_clear(now.world, there[0], there[1] + EYE_HEIGHT, there[2], x, chest, z):
            return float(heading)
    return float(away)


FIGHTERS = levels_of("fighter", "shoots at the nearest enemy, gathers in between", fight, 3)
