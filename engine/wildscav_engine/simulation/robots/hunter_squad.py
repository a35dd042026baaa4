"""The hunter squad: teammates keep together and shoot at one enemy, which one of them sees.

Its members are the robots of this kind in a team. The leader is the one in the first seat that is alive.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.aiming import (
    aim_and_fire,
    can_hurt,
    circle,
    nearest_enemy,
    reload_low_clip,
)
from wildscav_engine.simulation.robots.base import (
    Situation,
    gather,
    go_to,
    keep_safe,
    levels_of,
    visit_hot_spot,
    wander,
)
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field

KIND = 5
TOGETHER = 12.0  # m from the leader within which the others keep
CHASE = 40.0  # m within which they come to a teammate's enemy
HEALTH_WEIGHT = 0.2  # m per hp: the weak are shot first


@kernel
def hunt(now: Situation, action: NDArray[np.float32]) -> None:
    """Fight the squad's enemy, else gather near the leader, who leads to the hot spot or anywhere."""
    leader = _leader(now)
    prey = _prey(now, leader)
    enemy = prey if prey != NOBODY and _sees(now, now.seat, prey) else nearest_enemy(now)
    if enemy != NOBODY:
        circle(now, aim_and_fire(now, enemy, action), action)
        action[Field.PICK_UP] = 1.0
        return
    reload_low_clip(now, action)
    if keep_safe(now, action):
        return
    if prey != NOBODY and _distance(now, now.seat, prey) < CHASE:
        _go_to_seat(now, prey, action)
        return
    if leader != now.seat and _distance(now, now.seat, leader) > TOGETHER:
        _go_to_seat(now, leader, action)
        return
    if not gather(now, action) and not visit_hot_spot(now, action):
        wander(now, action)


@kernel
def _is_of_squad(now: Situation, seat: int) -> bool:
    """Return whether a seat is a living member of the robot's squad."""
    agents = now.agents
    is_mate = agents.team[seat] == agents.team[now.seat] and agents.robot[seat] // 10 == KIND
    return bool(is_mate and agents.health[seat] > 0)


@kernel
def _leader(now: Situation) -> int:
    """Return the first living member of the squad."""
    for seat in range(now.seat):
        if _is_of_squad(now, seat):
            return seat
    return now.seat


@kernel
def _prey(now: Situation, leader: int) -> int:
    """Return the enemy that the squad shoots at: near the leader and weak, among those in sight of anyone."""
    best, least = NOBODY, np.inf
    for mate in range(now.agents.health.shape[0]):
        # What other seats see may not be up to date.
        if not _is_of_squad(now, mate):
            continue
        for place in range(now.seen.agent_count[mate]):
            other = int(now.seen.agents[mate, place])
            cost = _distance(now, leader, other) + HEALTH_WEIGHT * now.agents.health[other]
            if can_hurt(now, other) and cost < least:
                best, least = other, cost
    return best


@kernel
def _sees(now: Situation, seat: int, other: int) -> bool:
    """Return whether an agent is in a robot's sight."""
    for place in range(now.seen.agent_count[seat]):  # noqa: SIM110 - kernels have no generators
        if now.seen.agents[seat, place] == other:
            return True
    return False


@kernel
def _distance(now: Situation, seat: int, other: int) -> float:
    """Return the horizontal distance between two agents in m."""
    one, two = now.agents.position[seat], now.agents.position[other]
    dx, dz = two[0] - one[0], two[2] - one[2]
    return float(np.sqrt(dx * dx + dz * dz))


@kernel
def _go_to_seat(now: Situation, seat: int, action: NDArray[np.float32]) -> None:
    """Walk to another agent, picking up what lies on the way."""
    there = now.agents.position[seat]
    action[Field.PICK_UP] = 1.0
    go_to(now, there[0], there[2], action)


HUNTER_SQUADS = levels_of(
    "hunter-squad", "keeps with its teammates of the same kind, who all shoot at one enemy", hunt, KIND
)
