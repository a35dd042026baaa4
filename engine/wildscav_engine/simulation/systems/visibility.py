"""What an agent can see of other agents and of supply boxes, as lists of the nearest."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine, wrap
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import Squares, column_of, row_of, squares_around
from wildscav_engine.geometry.rays import NOTHING_HIT, cast_ray, make_ray, meet_solid
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import NOBODY, Agents, Matches, Supplies
from wildscav_engine.simulation.systems.crowd import Crowd, crowd_of, index_agents
from wildscav_engine.simulation.systems.supplies import distance_to_box, is_there, squares_of_boxes
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.specs.rules import Rules

AGENT_LIMIT = 16  # agents at most in one observation
SUPPLY_LIMIT = 32  # supply boxes at most
ASPECT = 9.0 / 16.0  # height of the view over its width, in degrees
AXIS_POINTS = (0.95 * BODY_HEIGHT, 0.6 * BODY_HEIGHT, 0.2 * BODY_HEIGHT)  # m above the soles
SIDE_HEIGHT = 0.7 * BODY_HEIGHT  # m above the soles, of a point to the left and one to the right
SIDE = 0.8 * BODY_RADIUS  # m from the axis to those
SLACK = 0.01  # m, more than all rounding of where squares end


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
    world: World,
    agents: Agents,
    supplies: Supplies,
    matches: Matches,
    match: int,
    seat: int,
    rules: Rules,
    seen: Seen,
) -> None:
    """Find out what one agent of a match sees.

    Args:
        world: The static world.
        agents: The agents of the match, which have been indexed since they moved.
        supplies: Its boxes.
        matches: All matches.
        match: Which one it is.
        seat: Who looks.
        rules: The rules.
        seen: The match's slices; the seat's rows are written.
    """
    seen.agent_count[seat] = 0
    seen.supply_count[seat] = 0
    seen.can_pick_up[seat] = False
    for place in range(AGENT_LIMIT):
        seen.agents[seat, place], seen.agent_distance[seat, place] = NOBODY, 0.0
    for place in range(SUPPLY_LIMIT):
        seen.supplies[seat, place], seen.supply_distance[seat, place] = -1, 0.0
    if not agents.present[seat] or agents.health[seat] <= 0:
        return
    if agents.health.shape[0] > 1:
        crowd = crowd_of(world, agents, matches, match)
        _see_agents(world, agents, crowd, seat, rules.view_angle, seen)
    if supplies.quantity.shape[0] > 0:
        _see_supplies(
            world, agents, supplies, matches.box_squares[match], seat, matches.frame[match], rules, seen
        )


@kernel
def look_at_match(
    world: World,
    agents: Agents,
    supplies: Supplies,
    matches: Matches,
    match: int,
    rules: Rules,
    seen: Seen,
) -> None:
    """Find out what every agent of a match sees; see ``look_around``."""
    index_agents(world, agents, matches, match)
    for seat in range(agents.health.shape[0]):
        look_around(world, agents, supplies, matches, match, seat, rules, seen)


class Cone(NamedTuple):
    """The view of an agent from above."""

    x: float  # m, where it looks from
    z: float
    along_x: float  # unit vector of where it looks
    along_z: float
    least: float  # cosine of half its angle


@inlined_kernel
def _may_be_in_view(cone: Cone, x: float, z: float, reach: float) -> bool:
    """Return False only if no place up to ``reach`` m from (x, z) is in view, seen from above."""
    dx, dz = x - cone.x, z - cone.z
    along = dx * cone.along_x + dz * cone.along_z + reach
    # A place p in view has p · along >= |p| cos, and both sides change by ``reach`` at most.
    rest = along + reach * cone.least
    return bool(rest >= 0.0 and rest * rest >= (dx * dx + dz * dz) * (cone.least * cone.least))


@inlined_kernel
def _see_agents(world: World, agents: Agents, crowd: Crowd, seat: int, view_angle: float, seen: Seen) -> None:
    """List the nearest agents in view, ring after ring of squares around an agent.

    It stops where all that is farther away would not get into the list.
    """
    squares = crowd.squares
    x, z, yaw = agents.position[seat, 0], agents.position[seat, 2], agents.yaw[seat]
    cone = Cone(x, z, sine(yaw), cosine(yaw), cosine(view_angle * 0.5))
    middle_row, middle_column = row_of(squares, z), column_of(squares, x)
    half = 0.5 * (squares.width + squares.depth)  # more than half a diagonal
    for ring in range(squares.side):
        if seen.agent_count[seat] == AGENT_LIMIT:
            # Whoever is outside the rings before is at least so far away.
            gap = max(0.0, (ring - 1) * min(squares.width, squares.depth) - SLACK)
            if gap * gap > seen.agent_distance[seat, AGENT_LIMIT - 1]:
                break
        south, north = middle_row - ring, middle_row + ring
        for row in range(max(0, south), min(squares.side - 1, north) + 1):
            # The first and the last row of a ring are whole, of the others there are only the ends.
            stride = 1 if row in (south, north) or ring == 0 else 2 * ring
            for column in range(middle_column - ring, middle_column + ring + 1, stride):
                if not 0 <= column < squares.side:
                    continue
                other = crowd.heads[row * squares.side + column] - 1
                if other < 0 or not (ring == 0 or _square_may_be_in_view(squares, cone, row, column, half)):
                    continue
                while other >= 0:
                    if other != seat:
                        _look_at(world, agents, cone, seat, other, view_angle, seen)
                    other = crowd.links[other] - 1


@inlined_kernel
def _square_may_be_in_view(squares: Squares, cone: Cone, row: int, column: int, half: float) -> bool:
    """Return False only if no body in a square can be in view. What is outside the map counts as inside."""
    if row in (0, squares.side - 1) or column in (0, squares.side - 1):
        return True
    x = squares.west + (column + 0.5) * squares.width
    z = squares.south + (row + 0.5) * squares.depth
    return _may_be_in_view(cone, x, z, half + BODY_RADIUS)


@inlined_kernel
def _look_at(
    world: World, agents: Agents, cone: Cone, seat: int, other: int, view_angle: float, seen: Seen
) -> None:
    """Put another agent into an agent's list if it is in sight and there is room for it."""
    if not _may_be_in_view(cone, agents.position[other, 0], agents.position[other, 2], BODY_RADIUS):
        return
    dx = agents.position[other, 0] - agents.position[seat, 0]
    dy = agents.position[other, 1] - agents.position[seat, 1]
    dz = agents.position[other, 2] - agents.position[seat, 2]
    distance = dx * dx + dy * dy + dz * dz
    keys, items, count = seen.agent_distance[seat], seen.agents[seat], seen.agent_count[seat]
    if is_full_of_nearer(distance, other, count, keys, items):
        return
    if sees_body(world, agents, seat, other, view_angle):
        seen.agent_count[seat] = insert_nearest(distance, other, count, keys, items)


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


@inlined_kernel
def _see_supplies(
    world: World,
    agents: Agents,
    supplies: Supplies,
    heads: NDArray[np.int32],
    seat: int,
    frame: int,
    rules: Rules,
    seen: Seen,
) -> None:
    sight = rules.supply_sight * rules.supply_sight
    reach = rules.pick_up_distance * rules.pick_up_distance
    squares = squares_of_boxes(world)
    far = max(rules.supply_sight, 0.0)
    around = squares_around(squares, agents.position[seat, 0], agents.position[seat, 2], far)
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            slot = heads[row * squares.side + column] - 1
            while slot >= 0:
                distance = distance_to_box(agents, supplies, seat, slot)
                if distance <= sight and is_there(supplies, slot, frame):
                    seen.supply_count[seat] = insert_nearest(
                        distance,
                        slot,
                        seen.supply_count[seat],
                        seen.supply_distance[seat],
                        seen.supplies[seat],
                    )
                    seen.can_pick_up[seat] |= distance <= reach
                slot = supplies.next_in_square[slot] - 1


@inlined_kernel
def is_full_of_nearer(
    key: float, item: int, count: int, keys: NDArray[np.float64], items: NDArray[np.int32]
) -> bool:
    """Return whether a sorted list has no room for an item; of equal keys, the lesser item comes first."""
    last = items.shape[0] - 1
    if count <= last:
        return False
    return bool(keys[last] < key or (keys[last] == key and items[last] < item))


@kernel
def insert_nearest(
    key: float, item: int, count: int, keys: NDArray[np.float64], items: NDArray[np.int32]
) -> int:
    """Put an item into a list that is sorted by its key, dropping the last if it is full.

    Args:
        key: Of the item; of equal keys, the lesser item comes first.
        item: What to put in.
        count: How many are in it.
        keys: (N,) of the items.
        items: (N,).

    Returns:
        How many are in it now.
    """
    if is_full_of_nearer(key, item, count, keys, items):
        return count
    place = min(count, items.shape[0] - 1)
    while place > 0 and (keys[place - 1] > key or (keys[place - 1] == key and items[place - 1] > item)):
        keys[place], items[place] = keys[place - 1], items[place - 1]
        place -= 1
    keys[place], items[place] = key, item
    return int(min(count + 1, items.shape[0]))
