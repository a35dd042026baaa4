"""Exploring a map by walking: from the open ground into houses, up stairs and over rocks.

Ground nodes exist from the start. From each node near a solid, a body walks towards the eight neighbouring
lattice points with the engine's own motion. Where it arrives is the node at the other end of the edge; it is
added if it does not exist yet. On open ground nothing can be in the way, so edges between gentle neighbours
need no walk.
"""

import numpy as np

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.clearance import has_clearance, is_clear, is_free
from wildscav_engine.geometry.sweep import sweep_world
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.lattice import (
    BORDER,
    DIRECTIONS,
    FALLS,
    FINE,
    NEAR,
    NO_EDGE,
    OPEN,
    SPACING,
    Lattice,
    Nodes,
    Survey,
    add_node,
    is_gentle,
    neighbour,
    node_at,
    place_of,
)
from wildscav_engine.motion.collision import Bodies, Point
from wildscav_engine.motion.walking import on_steep_ground, walk
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, COS_SLOPE_LIMIT, TAN_SLOPE_LIMIT

SIDE_CLEARANCE = 0.04  # m that a body may be off a node or to the side of an edge and still arrive
MIDDLE_CLEARANCE = 0.05  # m halfway along a diagonal, so that bodies there and at its ends cover it
ARRIVAL = 0.02  # m; a body nearer than this to a lattice point has arrived
STEP_RISE = 0.25  # m; heights that differ by less are at most neighbouring steps of a flight
RISE = 0.66  # m; steps and slopes rise or drop by less over an edge
WAIST = 1.0  # m; less than the height of a body that stands RISE lower
SMALL_STRIDE = 0.02  # m per frame, of a body that walks at 1 m/s
EVEN, HALF_EDGE = 0.4, 0.7072  # m up per m, and m of the longest edges
LEVEL = 0.02  # m; smaller differences are no steps
STEEP_DROP = 0.7  # m down within a metre; steeper edges are candidates for getting down
NO_BODIES = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)  # around a body that walks alone
# m, greatest height difference over a diagonal that needs no walk if all sides can be walked
FLAT_DIAGONAL = 0.45


@kernel
def add_ground(world: World, lattice: Lattice, nodes: Nodes, row: int) -> None:
    """Add the ground nodes of one row of whole-metre points: where the slope is gentle and a body fits."""
    for column in range(BORDER, lattice.side - BORDER, 2):
        point = row * lattice.side + column
        x, z = place_of(world, lattice, point)
        if is_gentle(world, x, z, TAN_SLOPE_LIMIT):
            height = ground_at(world, x, z).height
            if lattice.marks[point] == OPEN or is_clear(world, x, height, z):
                add_node(nodes, point, height)
                if lattice.marks[point] == NEAR and _is_open_around(world, x, height, z):
                    lattice.marks[point] = OPEN


@kernel
def _is_open_around(world: World, x: float, height: float, z: float) -> bool:
    """Return whether no solid is near the first halves of all edges from here, and the ground is even."""
    rise = EVEN * HALF_EDGE
    if not is_gentle(world, x, z, EVEN):
        return False
    return is_free(world, x, height - rise, height + BODY_HEIGHT + rise, z, HALF_EDGE + SIDE_CLEARANCE)


@kernel
def explore(survey: Survey, start: int, capacity: int) -> int:
    """Find the edges of the nodes from ``start`` on, and of all nodes found in the process.

    It returns the first node without edges; it stops early if eight more nodes would not fit.
    """
    node, nodes = start, survey.nodes
    while node < nodes.found[0] and nodes.found[0] + DIRECTIONS < capacity:
        for direction in range(0, DIRECTIONS, 2):
            nodes.edges[node, direction] = _edge(survey, node, direction)
        node += 1
    return node


@kernel
def join_diagonals(survey: Survey, start: int, capacity: int) -> int:
    """Find the diagonal edges of nodes that have their straight ones; see ``explore``."""
    nodes = survey.nodes
    last = int(nodes.found[0])
    for node in range(start, last):
        if nodes.found[0] + DIRECTIONS >= capacity:
            return node
        for direction in range(1, DIRECTIONS, 2):
            across = _across_square(survey.lattice, nodes, node, direction)
            if across < 0:
                across = _edge(survey, node, direction)
            nodes.edges[node, direction] = across
    return last


@kernel
def _across_square(lattice: Lattice, nodes: Nodes, node: int, direction: int) -> int:
    """Return the opposite corner of a square if all four sides can be walked, else -1.

    No solid stands in such a square: one that blocked its inside would also block a side.
    """
    left = nodes.edges[node, (direction + 1) % DIRECTIONS]
    right = nodes.edges[node, direction - 1]
    if left < 0 or right < 0:
        return -1
    far = nodes.edges[left, direction - 1]
    if far < 0 or far != nodes.edges[right, (direction + 1) % DIRECTIONS]:
        return -1
    is_flat = abs(nodes.height[far] - nodes.height[node]) <= FLAT_DIAGONAL
    both_open = lattice.marks[nodes.point[node]] == OPEN and lattice.marks[nodes.point[far]] == OPEN
    return int(far) if is_flat or both_open else -1


@kernel
def _edge(survey: Survey, node: int, direction: int) -> int:
    """Return the node that a walk from a node in a direction leads to, NO_EDGE or FALLS."""
    world, no_bodies, lattice, nodes = survey
    point = int(nodes.point[node])
    target = neighbour(lattice, point, direction)
    if target < 0:
        return NO_EDGE
    if lattice.marks[point] == OPEN and lattice.marks[target] == OPEN:
        return _edge_over_open_ground(survey, node, target)
    other = _reverse_edge(lattice, nodes, node, target, direction)
    if other >= 0:
        return other
    x, z = place_of(world, lattice, point)
    to_x, to_z = place_of(world, lattice, target)
    start = Point(x, nodes.height[node], z)
    if lattice.marks[point] == FINE or lattice.marks[target] == FINE:
        return _edge_among_obstacles(survey, node, start, target, direction)
    other = int(nodes.first[target])
    if other >= 0 and _is_clear_between(world, start, to_x, to_z, nodes.height[other]):
        return other
    reached = walk_straight(world, no_bodies, start, to_x, to_z, SPACING)
    if np.isnan(reached):
        return FALLS
    end = Point(to_x, reached, to_z)
    arrives = abs(reached) < np.inf and leaves_clearance(
        world, no_bodies, start, end, SIDE_CLEARANCE, SPACING
    )
    return other if arrives else NO_EDGE


@kernel
def _edge_among_obstacles(survey: Survey, node: int, start: Point, target: int, direction: int) -> int:
    """Return the node that a walk in a house or on a rock leads to, NO_EDGE or FALLS; the node may be new."""
    world, no_bodies, lattice, nodes = survey
    x, z = place_of(world, lattice, target)
    reached = _height_if_free(world, start, x, z)
    if reached == -np.inf:
        if not is_free(world, x, start.y + RISE, start.y + WAIST, z, 0.0):
            return NO_EDGE  # at any possible height there, a body would overlap a solid
        back = _node_leading_here(nodes, node, target, direction)
        reached = _walk_up_or_down(world, no_bodies, start, x, z, back >= 0)
    if np.isnan(reached):
        return FALLS
    if reached == -np.inf:
        return NO_EDGE
    other = node_at(nodes, target, reached)
    if other < 0 and lattice.marks[target] == FINE:
        other = add_node(nodes, target, reached)
    return other


@kernel
def _height_if_free(world: World, start: Point, x: float, z: float) -> float:
    """Return the height in m of a place on the same level floor as the start, or on the ground like it.

    It is -inf if neither holds, or if a solid is near the path. Otherwise no walk is needed: if bodies fit at
    both ends and halfway, they cover the path between. The ground on the path is gentle if it is gentle
    around both ends, because every triangle of the terrain that the path crosses reaches one of them.
    """
    middle_x, middle_z = 0.5 * (start.x + x), 0.5 * (start.z + z)
    height, middle = start.y, start.y
    if abs(ground_at(world, start.x, start.z).height - start.y) <= LEVEL:
        height, middle = ground_at(world, x, z).height, ground_at(world, middle_x, middle_z).height
        if not (
            is_gentle(world, start.x, start.z, TAN_SLOPE_LIMIT) and is_gentle(world, x, z, TAN_SLOPE_LIMIT)
        ):
            return -np.inf
    elif not (_is_floored(world, x, height, z) and _is_floored(world, middle_x, height, middle_z)):
        return -np.inf
    if has_clearance(world, x, height, z, SIDE_CLEARANCE) and has_clearance(
        world, middle_x, middle, middle_z, MIDDLE_CLEARANCE
    ):
        return height
    return -np.inf


@kernel
def _is_floored(world: World, x: float, height: float, z: float) -> bool:
    """Return whether a body at a place in m stands on a solid that the ground does not cover."""
    if ground_at(world, x, z).height > height:
        return False
    contact = sweep_world(world, x, height, z, 0.0, -LEVEL, 0.0)
    return bool(contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT)


@kernel
def _walk_up_or_down(world: World, no_bodies: Bodies, start: Point, x: float, z: float, back: bool) -> float:
    """Do the same as ``walk_straight`` on steps and slopes of solids, with clearance on both sides.

    On such paths, small strides may get less far than large ones, so both have to arrive. If the edge
    ``back`` is already known to be walkable, one walk is enough.
    """
    reached = walk_straight(world, no_bodies, start, x, z, SPACING)
    if back or not abs(reached) < np.inf:
        return reached
    # The next step of a flight may begin right behind the end.
    if not is_free(world, x, reached + STEP_RISE, reached + BODY_HEIGHT, z, SIDE_CLEARANCE):
        return -np.inf
    reached = walk_straight(world, no_bodies, start, x, z, SMALL_STRIDE)
    end = Point(x, reached, z)
    if abs(reached) < np.inf and not leaves_clearance(world, no_bodies, start, end, SIDE_CLEARANCE, SPACING):
        return -np.inf
    return reached


@kernel
def _is_clear_between(world: World, start: Point, x: float, z: float, height: float) -> bool:
    """Return whether no solid is near the path from a point to a place at a height in m."""
    half = 0.5 * np.sqrt((x - start.x) * (x - start.x) + (z - start.z) * (z - start.z))
    middle = 0.5 * (start.y + height)
    middle_x, middle_z = 0.5 * (start.x + x), 0.5 * (start.z + z)
    if has_clearance(world, middle_x, middle, middle_z, half + SIDE_CLEARANCE):
        return True
    # Three bodies widened by this cover the path and SIDE_CLEARANCE beside it.
    wide = BODY_RADIUS + SIDE_CLEARANCE
    margin = np.sqrt(0.25 * half * half + wide * wide) - BODY_RADIUS
    return (
        has_clearance(world, middle_x, middle, middle_z, margin)
        and has_clearance(world, x, height, z, margin)
        and has_clearance(world, start.x, start.y, start.z, margin)
    )


@kernel
def _reverse_edge(lattice: Lattice, nodes: Nodes, node: int, target: int, direction: int) -> int:
    """Return the node from which an edge leads here that can also be walked back, -1 if there is none.

    A free path on the ground or on a level floor is free in both directions; one over steps may not be.
    """
    other = _node_leading_here(nodes, node, target, direction)
    if other < 0 or abs(nodes.height[other] - nodes.height[node]) <= LEVEL:
        return other
    on_ground = lattice.marks[nodes.point[node]] != FINE and lattice.marks[target] != FINE
    return other if on_ground else -1


@kernel
def _node_leading_here(nodes: Nodes, node: int, target: int, direction: int) -> int:
    """Return the node over the point ``target`` from which an edge leads to ``node``, or -1."""
    other = int(nodes.first[target])
    while other >= 0 and nodes.edges[other, (direction + DIRECTIONS // 2) % DIRECTIONS] != node:
        other = int(nodes.following[other])
    return other


@kernel
def _edge_over_open_ground(survey: Survey, node: int, target: int) -> int:
    """Return the ground node over a point; FALLS if the ground drops steeply there or right behind it."""
    world, _, lattice, nodes = survey
    if nodes.first[target] >= 0:
        return int(nodes.first[target])
    here_x, here_z = place_of(world, lattice, int(nodes.point[node]))
    x, z = place_of(world, lattice, target)
    behind = ground_at(world, 2.0 * x - here_x, 2.0 * z - here_z).height
    lowest = min(behind, ground_at(world, x, z).height)
    return FALLS if lowest < nodes.height[node] - STEEP_DROP else NO_EDGE


@kernel
def walk_straight(world: World, no_bodies: Bodies, start: Point, x: float, z: float, stride: float) -> float:
    """Walk straight to x and z in m with the engine's motion, in moves of up to ``stride`` m.

    It returns the height in m at which a body arrives; -inf if it does not arrive, NaN if it walks off an
    edge or slides.
    """
    return walk_within(world, no_bodies, start, x, z, stride, ARRIVAL)


@kernel
def walk_within(
    world: World, no_bodies: Bodies, start: Point, x: float, z: float, stride: float, arrival: float
) -> float:
    """Do the same as ``walk_straight``, if no move ends farther than ``arrival`` m from where it should."""
    at = start
    far = np.sqrt((x - start.x) * (x - start.x) + (z - start.z) * (z - start.z))
    moves = int(np.ceil(far / stride))
    for done in range(moves):
        at, short, stands = move_on(world, no_bodies, at, x, z, moves - done)
        if short > arrival:
            return -np.inf
        if not stands:
            return np.nan
    return at.y


@inlined_kernel
def move_on(
    world: World, no_bodies: Bodies, at: Point, x: float, z: float, left: int
) -> tuple[Point, float, bool]:
    """Make the first of the ``left`` equal moves that lead straight to a place.

    It returns where the body is then, how far in m that is from where it should be, and whether it stands.
    """
    share = 1.0 / left
    delta_x, delta_z = (x - at.x) * share, (z - at.z) * share
    moved = walk(world, no_bodies, at, delta_x, delta_z)
    short = abs(moved.x - at.x - delta_x) + abs(moved.z - at.z - delta_z)
    here = Point(moved.x, moved.y, moved.z)
    return here, short, moved.on_ground and not on_steep_ground(world, here)


@kernel
def leaves_clearance(
    world: World, no_bodies: Bodies, start: Point, end: Point, margin: float, stride: float
) -> bool:
    """Return whether a straight walk arrives about as high if shifted ``margin`` m to the left and right."""
    east, north = end.x - start.x, end.z - start.z
    share = margin / np.sqrt(east * east + north * north)
    for side in (-share, share):
        beside = Point(start.x - side * north, start.y, start.z + side * east)
        reached = walk_straight(world, no_bodies, beside, end.x - side * north, end.z + side * east, stride)
        if not abs(reached - end.y) <= STEP_RISE:
            return False
    return True
