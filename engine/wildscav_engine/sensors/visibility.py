"""What an agent can see of other agents and of supply boxes, as lists of the nearest."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.body import BODY_HEIGHT, EYE_HEIGHT
from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.rules import Rules
from wildscav_engine.state import NOBODY, Agents, Supplies
from wildscav_engine.systems.supplies import is_there
from wildscav_engine.trig import arctangent, wrap

AGENT_LIMIT = 16  # agents at most in one observation
SUPPLY_LIMIT = 32  # supply boxes at most
ASPECT = 9.0 / 16.0  # height of the view over its width, in degrees
BODY_POINTS = (0.95 * BODY_HEIGHT, 0.6 * BODY_HEIGHT, 0.2 * BODY_HEIGHT)  # m above the soles


class Seen(NamedTuple):
    """What every agent sees, nearest first; unused places hold -1."""

    agents: NDArray[np.int32]  # (B, A, 16) seats
    agent_count: NDArray[np.int32]  # (B, A)
    agent_distance: NDArray[np.float64]  # (B, A, 16) m², squared, of those
    supplies: NDArray[np.int32]  # (B, A, 32) slots of boxes
    supply_count: NDArray[np.int32]  # (B, A)
    supply_distance: NDArray[np.float64]  # (B, A, 32) m², squared, of those
    can_pick_up: NDArray[np.bool_]  # (B, A) whether a box is in reach


def allocate_seen(matches: int, seats: int) -> Seen:
    """Return arrays that say that nobody sees anything."""
    return Seen(
        agents=np.full((matches, seats, AGENT_LIMIT), NOBODY, np.int32),
        agent_count=np.zeros((matches, seats), np.int32),
        agent_distance=np.zeros((matches, seats, AGENT_LIMIT)),
        supplies=np.full((matches, seats, SUPPLY_LIMIT), -1, np.int32),
        supply_count=np.zeros((matches, seats), np.int32),
        supply_distance=np.zeros((matches, seats, SUPPLY_LIMIT)),
        can_pick_up=np.zeros((matches, seats), np.bool_),
    )


@kernel
def look_around(
    world: World, agents: Agents, supplies: Supplies, frame: int, rules: Rules, seen: Seen
) -> None:
    """Find out what every agent of one match sees.

    Args:
        world: The static world.
        agents: The agents of the match.
        supplies: Its boxes.
        frame: Its frame.
        rules: The rules.
        seen: The match's slices, written.
    """
    seats = agents.health.shape[0]
    for seat in range(seats):
        seen.agent_count[seat] = 0
        seen.supply_count[seat] = 0
        seen.can_pick_up[seat] = False
        seen.agents[seat] = NOBODY
        seen.supplies[seat] = -1
        if not agents.present[seat] or agents.health[seat] <= 0:
            continue
        _see_agents(world, agents, seat, rules.view_angle, seen)
        _see_supplies(agents, supplies, seat, frame, rules, seen)


@kernel
def _see_agents(world: World, agents: Agents, seat: int, view_angle: float, seen: Seen) -> None:
    for other in range(agents.health.shape[0]):
        if other == seat or not agents.present[other] or agents.health[other] <= 0:
            continue
        if sees_body(world, agents, seat, other, view_angle):
            dx = agents.position[other, 0] - agents.position[seat, 0]
            dy = agents.position[other, 1] - agents.position[seat, 1]
            dz = agents.position[other, 2] - agents.position[seat, 2]
            seen.agent_count[seat] = insert_nearest(
                dx * dx + dy * dy + dz * dz,
                other,
                seen.agent_count[seat],
                seen.agent_distance[seat],
                seen.agents[seat],
            )


@kernel
def sees_body(world: World, agents: Agents, seat: int, other: int, view_angle: float) -> bool:
    """Return whether a point of another's body is in an agent's view frustum with a clear line of sight."""
    eye_x = agents.position[seat, 0]
    eye_y = agents.position[seat, 1] + EYE_HEIGHT
    eye_z = agents.position[seat, 2]
    dx, dz = agents.position[other, 0] - eye_x, agents.position[other, 2] - eye_z
    level = np.sqrt(dx * dx + dz * dz)
    # Right above or below there is no compass direction: the pitch alone decides.
    if level > 0.0 and abs(wrap(arctangent(dx, dz) - agents.yaw[seat])) > view_angle * 0.5:
        return False
    for height in BODY_POINTS:
        point_y = agents.position[other, 1] + height
        pitch = arctangent(eye_y - point_y, level)
        if abs(pitch - agents.pitch[seat]) <= view_angle * ASPECT * 0.5 and sight_is_clear(
            world, eye_x, eye_y, eye_z, eye_x + dx, point_y, eye_z + dz
        ):
            return True
    return False


@kernel
def _see_supplies(
    agents: Agents,
    supplies: Supplies,
    seat: int,
    frame: int,
    rules: Rules,
    seen: Seen,
) -> None:
    sight = rules.supply_sight * rules.supply_sight
    reach = rules.pick_up_distance * rules.pick_up_distance
    for slot in range(supplies.quantity.shape[0]):
        if not is_there(supplies, slot, frame):
            continue
        dx = supplies.position[slot, 0] - agents.position[seat, 0]
        dy = supplies.position[slot, 1] - agents.position[seat, 1]
        dz = supplies.position[slot, 2] - agents.position[seat, 2]
        distance = dx * dx + dy * dy + dz * dz
        if distance <= sight:
            seen.supply_count[seat] = insert_nearest(
                distance, slot, seen.supply_count[seat], seen.supply_distance[seat], seen.supplies[seat]
            )
            seen.can_pick_up[seat] |= distance <= reach


@kernel
def insert_nearest(
    key: float, item: int, count: int, keys: NDArray[np.float64], items: NDArray[np.int32]
) -> int:
    """Put an item into a list that is sorted by its key, dropping the last if it is full.

    Args:
        key: Of the item; of equal keys, the first to come stays first.
        item: What to put in.
        count: How many are in it.
        keys: (N,) of the items.
        items: (N,).

    Returns:
        How many are in it now.
    """
    capacity = items.shape[0]
    if count == capacity:
        if key >= keys[count - 1]:
            return count
        count -= 1
    place = count
    while place > 0 and keys[place - 1] > key:
        keys[place], items[place] = keys[place - 1], items[place - 1]
        place -= 1
    keys[place], items[place] = key, item
    return count + 1
