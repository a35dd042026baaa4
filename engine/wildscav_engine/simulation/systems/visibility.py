"""The other agents and supply boxes that an agent can see, as lists of the nearest."""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine, wrap
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.compilation.passed_tables import pass_as_table
from wildscav_engine.geometry.linked_grid import Squares, column_of, row_of, squares_around
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT, intersect_solid, make_ray, raycast
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import (
    NOBODY,
    Agents,
    Axes,
    Count,
    Extent,
    Flag,
    Game,
    Supplies,
    allocate,
)
from wildscav_engine.simulation.systems.agent_grid import agent_grid_of
from wildscav_engine.simulation.systems.supplies import is_present, squared_distance_to_box, squares_of_boxes
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.specs.rules import Senses

AGENT_LIMIT = 16  # agents in one observation
SUPPLY_LIMIT = 32  # supply boxes in one observation
ASPECT = 9.0 / 16.0  # vertical over horizontal view angle
AXIS_POINTS = (0.95 * BODY_HEIGHT, 0.6 * BODY_HEIGHT, 0.2 * BODY_HEIGHT)  # m above the soles
SIDE_HEIGHT = 0.7 * BODY_HEIGHT  # m above the soles, of the points at the left and right side
SIDE = 0.8 * BODY_RADIUS  # m from the axis to those points
BOX_TOP = 0.4  # m above its place, the point of a box that must be in sight
SLACK = 0.01  # m, more than the rounding error of the edges of squares
BURIED = 1e-6  # m below the ground, where rounding cannot put what is above it


@pass_as_table
class Seen(NamedTuple):
    """What each agent sees, nearest first; unused entries are -1."""

    agents: Annotated[NDArray[np.int32], Axes(Extent.SEATS, (AGENT_LIMIT,), NOBODY)]  # seats
    agent_count: Count
    agent_distance_squared: Annotated[NDArray[np.float64], Axes(Extent.SEATS, (AGENT_LIMIT,))]  # m², of those
    supplies: Annotated[NDArray[np.int32], Axes(Extent.SEATS, (SUPPLY_LIMIT,), -1)]  # slots of boxes
    supply_count: Count
    # m², of those
    supply_distance_squared: Annotated[NDArray[np.float64], Axes(Extent.SEATS, (SUPPLY_LIMIT,))]
    can_pick_up: Flag  # whether a box is in reach
    tells_condition: Flag  # whether the velocities and the health of those agents are known, too


def allocate_seen(matches: int, seats: int) -> Seen:
    """Return arrays in which no agent sees anything."""
    return allocate(Seen, matches, [seats])


@kernel
def find_seen(game: Game, seat: int, seen: Seen) -> None:
    """Update the row of what one agent of a match sees; the grid of its agents is up to date."""
    agents, rules = game.agents, game.rules
    seen.agent_count[seat] = 0
    seen.supply_count[seat] = 0
    seen.can_pick_up[seat] = False
    seen.tells_condition[seat] = rules.senses == Senses.ORIGINAL
    for place in range(AGENT_LIMIT):
        seen.agents[seat, place], seen.agent_distance_squared[seat, place] = NOBODY, 0.0
    for place in range(SUPPLY_LIMIT):
        seen.supplies[seat, place], seen.supply_distance_squared[seat, place] = -1, 0.0
    if not agents.present[seat] or agents.health[seat] <= 0:
        return
    # Robots have no eyes but these.
    has_lists = rules.senses != Senses.PIXELS or agents.robot[seat] != 0
    if agents.health.shape[0] > 1 and has_lists:
        _see_agents(game, seat, seen)
    if game.supplies.quantity.shape[0] > 0:
        _see_supplies(game, seat, has_lists, seen)


class Cone(NamedTuple):
    """The view of an agent from above."""

    x: float  # m, position of the eye
    z: float
    along_x: float  # unit vector of the view direction
    along_z: float
    min_cosine: float  # cosine of half its angle


@inlined_kernel
def _may_be_in_view(cone: Cone, x: float, z: float, reach: float) -> bool:
    """Return False only if no point within ``reach`` m of (x, z) is in view, seen from above."""
    dx, dz = x - cone.x, z - cone.z
    along = dx * cone.along_x + dz * cone.along_z + reach
    # A point p in view has p · along >= |p| cos, and both sides change by at most ``reach``.
    rest = along + reach * cone.min_cosine
    return bool(rest >= 0.0 and rest * rest >= (dx * dx + dz * dz) * (cone.min_cosine * cone.min_cosine))


@inlined_kernel
def _see_agents(game: Game, seat: int, seen: Seen) -> None:
    """List the nearest agents in view, searching ring after ring of squares around an agent.

    The search stops when all agents in further rings are too far away to get into the list.
    """
    agents, grid = game.agents, agent_grid_of(game)
    squares = grid.squares
    x, z, yaw = agents.position[seat, 0], agents.position[seat, 2], agents.yaw[seat]
    cone = Cone(x, z, sine(yaw), cosine(yaw), cosine(game.rules.view_angle * 0.5))
    middle_row, middle_column = row_of(squares, z), column_of(squares, x)
    half = 0.5 * (squares.width + squares.depth)  # more than half a diagonal
    for ring in range(squares.side):
        if seen.agent_count[seat] == AGENT_LIMIT:
            # Agents outside the previous rings are at least this far away.
            gap = max(0.0, (ring - 1) * min(squares.width, squares.depth) - SLACK)
            if gap * gap > seen.agent_distance_squared[seat, AGENT_LIMIT - 1]:
                break
        south, north = middle_row - ring, middle_row + ring
        for row in range(max(0, south), min(squares.side - 1, north) + 1):
            # A ring has all squares of its first and last row, and only the two ends of the others.
            stride = 1 if row in (south, north) or ring == 0 else 2 * ring
            for column in range(middle_column - ring, middle_column + ring + 1, stride):
                if not 0 <= column < squares.side:
                    continue
                other = grid.heads[row * squares.side + column] - 1
                if other < 0 or not (ring == 0 or _square_may_be_in_view(squares, cone, row, column, half)):
                    continue
                while other >= 0:
                    if other != seat:
                        _add_if_seen(game, cone, seat, other, seen)
                    other = grid.links[other] - 1


@inlined_kernel
def _square_may_be_in_view(squares: Squares, cone: Cone, row: int, column: int, half: float) -> bool:
    """Return False only if no body in a square can be in view. Squares at the edge extend beyond the map."""
    if row in (0, squares.side - 1) or column in (0, squares.side - 1):
        return True
    x = squares.west + (column + 0.5) * squares.width
    z = squares.south + (row + 0.5) * squares.depth
    return _may_be_in_view(cone, x, z, half + BODY_RADIUS)


@inlined_kernel
def _add_if_seen(game: Game, cone: Cone, seat: int, other: int, seen: Seen) -> None:
    """Add another agent to an agent's list if it is in sight and near enough for the list."""
    agents = game.agents
    if not _may_be_in_view(cone, agents.position[other, 0], agents.position[other, 2], BODY_RADIUS):
        return
    dx = agents.position[other, 0] - agents.position[seat, 0]
    dy = agents.position[other, 1] - agents.position[seat, 1]
    dz = agents.position[other, 2] - agents.position[seat, 2]
    distance = dx * dx + dy * dy + dz * dz
    keys, items, count = seen.agent_distance_squared[seat], seen.agents[seat], seen.agent_count[seat]
    if is_full_of_nearer(distance, other, count, keys, items):
        return
    place = agents.position[other]
    if sees_body(game.world, eye_of(agents, seat, game.rules.view_angle), place[0], place[1], place[2]):
        seen.agent_count[seat] = insert_nearest(distance, other, count, keys, items)


class Eye(NamedTuple):
    """The eye of an agent, by itself: kernels with few arguments are called faster than with all agents."""

    x: float  # m
    y: float
    z: float
    yaw: float  # degrees
    pitch: float  # degrees, positive looks down
    view_angle: float  # degrees, horizontal


@inlined_kernel
def eye_of(agents: Agents, seat: int, view_angle: float) -> Eye:
    """Return the eye of an agent."""
    x, y, z = agents.position[seat, 0], agents.position[seat, 1], agents.position[seat, 2]
    return Eye(x, y + EYE_HEIGHT, z, agents.yaw[seat], agents.pitch[seat], view_angle)


@kernel
def sees_body(world: World, eye: Eye, x: float, y: float, z: float) -> bool:
    """Return whether a point of a body, whose soles are given, is in view with a clear line of sight.

    Three of the points are on the axis of the body and two at its sides as the eye sees them, so that a
    body half behind a corner is seen. Those on the axis are tested first because they decide most cases.
    """
    dx, dz = x - eye.x, z - eye.z
    level = np.sqrt(dx * dx + dz * dz)
    # Directly above or below, there is no bearing and no side, so only the pitch counts.
    off = abs(wrap(arctangent(dx, dz) - eye.yaw)) if level > 0.0 else 0.0
    # What was in the way last, and at what share of the way: it is often in the way again.
    hidden_by, share = NOTHING_HIT, 0.0
    if off <= eye.view_angle * 0.5:
        for height in AXIS_POINTS:
            if hidden_by == TERRAIN_HIT:
                break  # ground that hides a point of the axis hides the lower ones
            sees, hidden_by, share = _sees_point(world, eye, x, y + height, z, hidden_by, share)
            if sees:
                return True
    if level == 0.0 or off - arctangent(SIDE, level) > eye.view_angle * 0.5:
        return False
    for side in (-SIDE / level, SIDE / level):
        aside_x, aside_z = side * dz, -side * dx
        bearing = arctangent(dx + aside_x, dz + aside_z)
        if abs(wrap(bearing - eye.yaw)) > eye.view_angle * 0.5:
            continue
        side_x, side_z = x + aside_x, z + aside_z
        sees, hidden_by, share = _sees_point(world, eye, side_x, y + SIDE_HEIGHT, side_z, hidden_by, share)
        if sees:
            return True
    return False


@kernel
def _sees_point(
    world: World, eye: Eye, x: float, y: float, z: float, hidden_by: int, share: float
) -> tuple[bool, int, float]:
    """Test whether a point is visible: within the vertical view angle, with a clear line of sight.

    What may be in the way is tested first: a solid, or TERRAIN_HIT at a share of the way. If the point is not
    visible, what hides it is returned, too, and at what share.
    """
    dx, dy, dz = x - eye.x, y - eye.y, z - eye.z
    pitch = arctangent(-dy, np.sqrt(dx * dx + dz * dz))
    if abs(pitch - eye.pitch) > eye.view_angle * ASPECT * 0.5:
        return False, hidden_by, share
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    if distance == 0.0:
        return True, hidden_by, share
    if hidden_by == TERRAIN_HIT:
        ground = ground_at(world, eye.x + share * dx, eye.z + share * dz).height
        if ground > eye.y + share * dy + BURIED:
            return False, hidden_by, share
    dx, dy, dz = dx / distance, dy / distance, dz / distance
    if hidden_by >= 0:
        ray = make_ray(world, eye.x, eye.y, eye.z, dx, dy, dz)
        if intersect_solid(world, hidden_by, ray, distance)[0] <= distance:
            return False, hidden_by, share
    hit = raycast(world, eye.x, eye.y, eye.z, dx, dy, dz, distance)
    return hit.solid == NOTHING_HIT, hit.solid, hit.distance / distance


@inlined_kernel
def _see_supplies(game: Game, seat: int, has_lists: bool, seen: Seen) -> None:
    """List the nearest boxes, and find out whether one is in reach, which an agent feels without any list."""
    world, agents, supplies, rules = game.world, game.agents, game.supplies, game.rules
    heads, frame = game.matches.box_squares[game.match], game.matches.frame[game.match]
    sight = rules.supply_sight * rules.supply_sight
    reach = rules.pick_up_distance * rules.pick_up_distance
    lists_all, eye = rules.senses == Senses.ORIGINAL, eye_of(agents, seat, rules.view_angle)
    squares = squares_of_boxes(world)
    far = max(rules.supply_sight, 0.0)
    around = squares_around(squares, agents.position[seat, 0], agents.position[seat, 2], far)
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            slot = heads[row * squares.side + column] - 1
            while slot >= 0:
                distance = squared_distance_to_box(agents, supplies, seat, slot)
                if distance <= sight and is_present(supplies, slot, frame):
                    seen.can_pick_up[seat] |= distance <= reach
                    if has_lists and (lists_all or _sees_box(world, eye, supplies, slot)):
                        keys, items = seen.supply_distance_squared[seat], seen.supplies[seat]
                        count = seen.supply_count[seat]
                        seen.supply_count[seat] = insert_nearest(distance, slot, count, keys, items)
                slot = supplies.next_in_square[slot] - 1


@kernel
def _sees_box(world: World, eye: Eye, supplies: Supplies, slot: int) -> bool:
    """Return whether the top of a box is in sight."""
    x, y, z = supplies.position[slot, 0], supplies.position[slot, 1], supplies.position[slot, 2]
    return sees_point(world, eye, x, y + BOX_TOP, z)


@kernel
def sees_point(world: World, eye: Eye, x: float, y: float, z: float) -> bool:
    """Return whether a point is in view with a clear line of sight."""
    dx, dz = x - eye.x, z - eye.z
    if (dx != 0.0 or dz != 0.0) and abs(wrap(arctangent(dx, dz) - eye.yaw)) > eye.view_angle * 0.5:
        return False
    return _sees_point(world, eye, x, y, z, NOTHING_HIT, 0.0)[0]


@inlined_kernel
def is_full_of_nearer(
    key: float, item: int, count: int, keys: NDArray[np.float64], items: NDArray[np.int32]
) -> bool:
    """Return whether a sorted list is full of nearer items; of equal keys, the lesser item comes first."""
    last = items.shape[0] - 1
    if count <= last:
        return False
    return bool(keys[last] < key or (keys[last] == key and items[last] < item))


@kernel
def insert_nearest(
    key: float, item: int, count: int, keys: NDArray[np.float64], items: NDArray[np.int32]
) -> int:
    """Insert an item into (N,) a list sorted by (N,) keys, and return its new length.

    A full list drops its last item. Of equal keys, the lesser item comes first.
    """
    if is_full_of_nearer(key, item, count, keys, items):
        return count
    place = min(count, items.shape[0] - 1)
    while place > 0 and (keys[place - 1] > key or (keys[place - 1] == key and items[place - 1] > item)):
        keys[place], items[place] = keys[place - 1], items[place - 1]
        place -= 1
    keys[place], items[place] = key, item
    return int(min(count + 1, items.shape[0]))
