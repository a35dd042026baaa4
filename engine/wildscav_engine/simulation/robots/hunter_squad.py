"""The hunter squad: teammates keep together, share the boxes, and shoot at one enemy, which one of them sees.

Its members are the robots of this kind in a team. The leader is the one who has most of the others around it.
"""

from enum import IntEnum

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
    Memory,
    Situation,
    gives_up,
    go_to,
    keep_safe,
    levels_of,
    visit_hot_spot,
    wander,
)
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field

KIND = 5
TOGETHER = 16.0  # m from the leader within which the others keep
AROUND = 30.0  # m around a member within which others count as its company
CHASE = 40.0  # m within which they come to a teammate's enemy
HEALTH_WEIGHT = 0.2  # m per hp: the weak are shot first
ALL_ROUND = 360.0  # degrees by which a member turns that was hit by an enemy whom nobody sees


class SquadMemory(IntEnum):
    """Where a member keeps its own numbers in its memory: in places that it does not need otherwise."""

    HEALTH = Memory.NEAREST  # hp when it last decided
    TURN_LEFT = Memory.DETOURS  # degrees by which it still turns to find who hit it
    SUPPLIES = Memory.DETOUR_SIDE  # those that it carried when it last decided


@kernel
def hunt(now: Situation, action: NDArray[np.float32]) -> None:
    """Fight the squad's enemy, else gather near the leader, who leads to the hot spot or anywhere."""
    _notice_changes(now)
    leader = _leader(now)
    prey = _prey(now, leader)
    enemy = prey if prey != NOBODY and _sees(now, now.seat, prey) else nearest_enemy(now)
    if enemy != NOBODY:
        circle(now, enemy, aim_and_fire(now, enemy, action), action)
        action[Field.PICK_UP] = 1.0
        return
    reload_low_clip(now, action)
    if not keep_safe(now, action):
        _move_on(now, prey, leader, action)
    if prey == NOBODY:
        _look_round(now, action)


@kernel
def _move_on(now: Situation, prey: int, leader: int, action: NDArray[np.float32]) -> None:
    """Come to the squad's enemy or to the leader, else gather, else go on; for members that see no enemy."""
    if prey != NOBODY and _distance(now, now.seat, prey) < CHASE:
        _go_to_seat(now, prey, action)
    elif leader != now.seat and _distance(now, now.seat, leader) > TOGETHER:
        _go_to_seat(now, leader, action)
    elif not _gather_own(now, action) and not visit_hot_spot(now, action):
        wander(now, action)


@kernel
def _notice_changes(now: Situation) -> None:
    """Notice a hit, after which it looks round, and a box, after which no other one seems out of reach."""
    agents, seat = now.agents, now.seat
    memory = agents.memory[seat]
    if agents.health[seat] < memory[SquadMemory.HEALTH]:
        memory[SquadMemory.TURN_LEFT] = ALL_ROUND
    if agents.supplies[seat] > memory[SquadMemory.SUPPLIES]:
        memory[Memory.FETCHING] = 0.0
    memory[SquadMemory.HEALTH], memory[SquadMemory.SUPPLIES] = agents.health[seat], agents.supplies[seat]


@kernel
def _look_round(now: Situation, action: NDArray[np.float32]) -> None:
    """Go on turning to find the one who hit it, if it was hit."""
    memory = now.agents.memory[now.seat]
    if memory[SquadMemory.TURN_LEFT] > 0.0:
        memory[SquadMemory.TURN_LEFT] -= now.skill.turn_limit
        action[Field.TURN] = now.skill.turn_limit / now.frames_per_action


@kernel
def _gather_own(now: Situation, action: NDArray[np.float32]) -> bool:
    """Walk to the nearest box to which no other member is nearer; return False if there is none."""
    action[Field.PICK_UP] = 1.0
    count = now.seen.supply_count[now.seat]
    if count == 0 or gives_up(now):
        return False
    for place in range(count):
        box = now.supplies.position[now.seen.supplies[now.seat, place]]
        if not _is_anothers(now, box[0], box[2]):
            go_to(now, box[0], box[2], action)
            return True
    return False


@kernel
def _is_anothers(now: Situation, x: float, z: float) -> bool:
    """Return whether another member is nearer to a place than the robot."""
    own = _squared_distance(now, now.seat, x, z)
    for seat in range(now.agents.health.shape[0]):
        if seat != now.seat and _is_of_squad(now, seat) and _squared_distance(now, seat, x, z) < own:
            return True
    return False


@kernel
def _is_of_squad(now: Situation, seat: int) -> bool:
    """Return whether a seat is a living member of the robot's squad."""
    agents = now.agents
    is_mate = agents.team[seat] == agents.team[now.seat] and agents.robot[seat] // 10 == KIND
    return bool(is_mate and agents.health[seat] > 0)


@kernel
def _leader(now: Situation) -> int:
    """Return the living member that has most of the others around it, the first of several."""
    leader, most = now.seat, -1
    for seat in range(now.agents.health.shape[0]):
        if _is_of_squad(now, seat):
            company = _company(now, seat)
            if company > most:
                leader, most = seat, company
    return leader


@kernel
def _company(now: Situation, seat: int) -> int:
    """Return how many members are around a member, with itself."""
    company, here = 0, now.agents.position[seat]
    for other in range(now.agents.health.shape[0]):
        is_mate = _is_of_squad(now, other)
        if is_mate and _squared_distance(now, other, here[0], here[2]) < AROUND * AROUND:
            company += 1
    return company


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
    there = now.agents.position[other]
    return float(np.sqrt(_squared_distance(now, seat, there[0], there[2])))


@kernel
def _squared_distance(now: Situation, seat: int, x: float, z: float) -> float:
    """Return the squared horizontal distance between an agent and a place in m²."""
    here = now.agents.position[seat]
    dx, dz = x - here[0], z - here[2]
    return float(dx * dx + dz * dz)


@kernel
def _go_to_seat(now: Situation, seat: int, action: NDArray[np.float32]) -> None:
    """Walk to another agent, picking up what lies on the way."""
    there = now.agents.position[seat]
    action[Field.PICK_UP] = 1.0
    go_to(now, there[0], there[2], action)


HUNTER_SQUADS = levels_of(
    "hunter-squad", "keeps with its teammates of the same kind, who all shoot at one enemy", hunt, KIND
)
