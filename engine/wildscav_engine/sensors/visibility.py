"""What an agent can see of other agents and of supply boxes, as lists of the nearest."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.geometry.rays import NOTHING_HIT, cast_ray, make_ray, meet_solid
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.rules import Rules
from wildscav_engine.state import NOBODY, Agents, Supplies
from wildscav_engine.systems.supplies import is_there
from wildscav_engine.trig import arctangent, wrap

AGENT_LIMIT = 16  # agents at most in one observation
SUPPLY_LIMIT = 32  # supply boxes at most
ASPECT = 9.0 / 16.0  # height of the view over its width, in degrees
AXIS_POINTS = (0.95 * BODY_HEIGHT, 0.6 * BODY_HEIGHT, 0.2 * BODY_HEIGHT)  # m above the soles
SIDE_HEIGHT = 0.7 * BODY_HEIGHT  # m above the soles, of a point to the left and one to the right
SIDE = 0.8 * BODY_RADIUS  # m from the axis to those


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
    """Return whether a point of another's body is in an agent's view frustum with a clear line of sight.

    The points are three on the body's axis and two at its sides, as the agent sees them, so that a body half
    behind a corner is seen. Those on the axis come first: they decide most cases.
    """
    dx = agents.position[other, 0] - agents.position[seat, 0]
    dz = agents.position[other, 2] - agents.position[seat, 2]
    level = np.sqrt(dx * dx + dz * dz)
    # Right above or below there is no compass direction, and no side: the pitch alone decides.
    off = abs(wrap(arctangent(dx, dz) - agents.yaw[seat])) if level > 0.0 else 0.0
    hidden_by = NOTHING_HIT  # what was in the way last, which is often in the way again
    if off <= view_angle * 0.5:
        for height in AXIS_POINTS:
            aside = (0.0, height, 0.0)
            sees, hidden_by = _sees_point(world, agents, seat, other, aside, view_angle, hidden_by)
            if sees:
                return True
    if level == 0.0 or off - arctangent(SIDE, level) > view_angle * 0.5:
        return False
    for side in (-SIDE / level, SIDE / level):
        aside = (side * dz, SIDE_HEIGHT, -side * dx)
        bearing = arctangent(dx + aside[0], dz + aside[2])
        if abs(wrap(bearing - agents.yaw[seat])) > view_angle * 0.5:
            continue
        sees, hidden_by = _sees_point(world, agents, seat, other, aside, view_angle, hidden_by)
        if sees:
            return True
    return False


@kernel
def _sees_point(
    world: World,
    agents: Agents,
    seat: int,
    other: int,
    offset: tuple[float, float, float],
    view_angle: float,
    hidden_by: int,
) -> tuple[bool, int]:
    """Look at a point of another's body.

    Args:
        world: The static world.
        agents: The agents of the match.
        seat: Who looks.
        other: At whom.
        offset: m, of the point from the other's soles.
        view_angle: Degrees, width of the view.
        hidden_by: A solid that may well be in the way, or what is none; it is tried first.

    Returns:
        Whether the point is at a height in view with a clear line of sight, and what is in the way if not.
    """
    eye_x, eye_z = agents.position[seat, 0], agents.position[seat, 2]
    eye_y = agents.position[seat, 1] + EYE_HEIGHT
    x = agents.position[other, 0] + offset[0]
    y = agents.position[other, 1] + offset[1]
    z = agents.position[other, 2] + offset[2]
    level = np.sqrt((x - eye_x) * (x - eye_x) + (z - eye_z) * (z - eye_z))
    pitch = arctangent(eye_y - y, level)
    if abs(pitch - agents.pitch[seat]) > view_angle * ASPECT * 0.5:
        return False, hidden_by
    way_x, way_y, way_z = x - eye_x, y - eye_y, z - eye_z
    distance = np.sqrt(way_x * way_x + way_y * way_y + way_z * way_z)
    if distance == 0.0:
        return True, hidden_by
    way_x, way_y, way_z = way_x / distance, way_y / distance, way_z / distance
    if hidden_by >= 0:
        ray = make_ray(world, eye_x, eye_y, eye_z, way_x, way_y, way_z)
        if meet_solid(world, hidden_by, ray, distance)[0] <= distance:
            return False, hidden_by
    hit = cast_ray(world, eye_x, eye_y, eye_z, way_x, way_y, way_z, distance)
    return hit.solid == NOTHING_HIT, hit.solid


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
