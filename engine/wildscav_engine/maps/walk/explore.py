"""Exploring a map by walking: from the open ground into houses, up stairs and over rocks.

Ground nodes are there from the start. From each node that is near anything, a body walks towards the eight
neighbouring lattice points with the engine's own motion; where it arrives is the node at the other end of
the edge, a new one if nobody has stood there yet. Over open ground nothing can be in the way, so edges
between gentle neighbours need no walk.
"""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.clearance import has_room, is_clear, is_free
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
    add_node,
    is_gentle,
    neighbour,
    node_at,
    place_of,
)
from wildscav_engine.motion.collision import Bodies, Point
from wildscav_engine.motion.walking import on_steep_ground, walk
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, COS_SLOPE_LIMIT, TAN_SLOPE_LIMIT

ROOM = 0.04  # m around a node and to each side of an edge that a body may be off, and still arrive
MIDDLE_ROOM = 0.05  # m half way along a diagonal, so that bodies there and at its ends cover it
ARRIVAL = 0.02  # m, nearer than this to a lattice point is there
A_STEP = 0.25  # m, heights that differ less are neighbouring steps of a flight at most
RISE = 0.66  # m, more than steps or slopes rise or drop over an edge
WAIST = 1.0  # m, less than a body's height above what is RISE lower
SMALL_STRIDE = 0.02  # m, of a body that walks at 1 m/s
EVEN, HALF_EDGE = 0.4, 0.7072  # m up per m, and m of the longest edges
LEVEL = 0.02  # m, a difference that is no step
STEEP_DROP = 0.7  # m down in a metre is looked at as a way to get down
FLAT_DIAGONAL = 0.45  # m between the ends of a diagonal that needs no walk where all sides can be walked


@kernel
def add_ground(world: World, lattice: Lattice, nodes: Nodes, row: int) -> None:
    """Add the ground nodes of one row of whole metres: where the slope is gentle and a body fits."""
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
    """Return whether nothing stands near the halves of all edges from here, and the ground is even."""
    rise = EVEN * HALF_EDGE
    if not is_gentle(world, x, z, EVEN):
        return False
    return is_free(world, x, height - rise, height + BODY_HEIGHT + rise, z, HALF_EDGE + ROOM)


@kernel
def explore(world: World, nobody: Bodies, lattice: Lattice, nodes: Nodes, start: int, room: int) -> int:
    """Find the edges of the nodes from ``start`` on, and of all nodes that are found on the way.

    Args:
        world: The static world.
        nobody: No bodies.
        lattice: Of the map.
        nodes: Filled.
        start: First node without edges.
        room: Nodes that the tables have room for.

    Returns:
        The first node without edges: all have theirs, or there is no room left for eight more nodes.
    """
    node = start
    while node < nodes.found[0] and nodes.found[0] + DIRECTIONS < room:
        for direction in range(0, DIRECTIONS, 2):
            nodes.edges[node, direction] = _edge(world, nobody, lattice, nodes, node, direction)
        node += 1
    return node


@kernel
def join_diagonals(
    world: World, nobody: Bodies, lattice: Lattice, nodes: Nodes, start: int, room: int
) -> int:
    """Find the diagonal edges of nodes that have their straight ones; see ``explore``."""
    last = int(nodes.found[0])
    for node in range(start, last):
        if nodes.found[0] + DIRECTIONS >= room:
            return node
        for direction in range(1, DIRECTIONS, 2):
            across = _across_square(lattice, nodes, node, direction)
            if across < 0:
                across = _edge(world, nobody, lattice, nodes, node, direction)
            nodes.edges[node, direction] = across
    return last


@kernel
def _across_square(lattice: Lattice, nodes: Nodes, node: int, direction: int) -> int:
    """Return the far corner of a square whose four sides can all be walked, -1 if it is not such a square.

    Nothing stands in such a square: whatever keeps a body's middle out of a disc of its radius also
    reaches a side.
    """
    left = nodes.edges[node, (direction + 1) % DIRECTIONS]
    right = nodes.edges[node, direction - 1]
    if left < 0 or right < 0:
        return -1
    far = nodes.edges[left, direction - 1]
    if far < 0 or far != nodes.edges[right, (direction + 1) % DIRECTIONS]:
        return -1
    is_flat = abs(nodes.height[far] - nodes.height[node]) <= FLAT_DIAGONAL
    both_open = _is_open(lattice, nodes, node) and _is_open(lattice, nodes, far)
    return int(far) if is_flat or both_open else -1


@kernel
def _is_open(lattice: Lattice, nodes: Nodes, node: int) -> bool:
    return bool(lattice.marks[nodes.point[node]] == OPEN)


@kernel
def _edge(world: World, nobody: Bodies, lattice: Lattice, nodes: Nodes, node: int, direction: int) -> int:
    """Return the node that a walk from a node in a direction leads to, NO_EDGE or FALLS."""
    point = int(nodes.point[node])
    target = neighbour(lattice, point, direction)
    if target < 0:
        return NO_EDGE
    if lattice.marks[point] == OPEN and lattice.marks[target] == OPEN:
        return _edge_over_open_ground(world, lattice, nodes, node, target)
    other = _known_the_other_way(lattice, nodes, node, target, direction)
    if other >= 0:
        return other
    x, z = place_of(world, lattice, point)
    to_x, to_z = place_of(world, lattice, target)
    start = Point(x, nodes.height[node], z)
    if lattice.marks[point] == FINE or lattice.marks[target] == FINE:
        return _edge_among_things(world, nobody, lattice, nodes, node, start, target, direction)
    other = int(nodes.first[target])
    if other >= 0 and _is_roomy(world, start, to_x, to_z, nodes.height[other]):
        return other
    reached = walk_straight(world, nobody, start, to_x, to_z, SPACING)
    if np.isnan(reached):
        return FALLS
    arrives = abs(reached) < np.inf and leaves_room(world, nobody, start, to_x, to_z, reached, ROOM, SPACING)
    return other if arrives else NO_EDGE


@kernel
def _edge_among_things(
    world: World,
    nobody: Bodies,
    lattice: Lattice,
    nodes: Nodes,
    node: int,
    start: Point,
    target: int,
    direction: int,
) -> int:
    """Return the node that a walk in a house or on a rock leads to, NO_EDGE or FALLS; it may be a new one."""
    x, z = place_of(world, lattice, target)
    reached = _height_if_free(world, start, x, z)
    if reached == -np.inf:
        if not is_free(world, x, start.y + RISE, start.y + WAIST, z, 0.0):
            return NO_EDGE  # whatever it stands on there, a body would have to be in there
        back = _leads_here(nodes, node, target, direction)
        reached = _walk_up_or_down(world, nobody, start, x, z, back >= 0)
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
    """Return the height in m at a place that is on the same level floor, or on the ground as the start is.

    It is -inf where it is on neither, or where anything stands near the way. No walk is needed there: bodies
    that have room at both ends and half way cover the way between. The ground on the way is gentle if it is
    gentle around both ends, because every triangle of the terrain that the way crosses reaches one of them.
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
    if has_room(world, x, height, z, ROOM) and has_room(world, middle_x, middle, middle_z, MIDDLE_ROOM):
        return height
    return -np.inf


@kernel
def _is_floored(world: World, x: float, height: float, z: float) -> bool:
    """Return whether a body at a place in m stands on something that the ground does not cover."""
    if ground_at(world, x, z).height > height:
        return False
    contact = sweep_world(world, x, height, z, 0.0, -LEVEL, 0.0)
    return bool(contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT)


@kernel
def _walk_up_or_down(world: World, nobody: Bodies, start: Point, x: float, z: float, back: bool) -> float:
    """Return what ``walk_straight`` does, for ways over steps and slopes of things; they leave room.

    There, small strides may get less far than great ones, so both have to arrive. Where the way ``back`` is
    known to be like that, one walk is enough.
    """
    reached = walk_straight(world, nobody, start, x, z, SPACING)
    if back or not abs(reached) < np.inf:
        return reached
    # Right behind the end, the next step of a flight may begin.
    if not is_free(world, x, reached + A_STEP, reached + BODY_HEIGHT, z, ROOM):
        return -np.inf
    reached = walk_straight(world, nobody, start, x, z, SMALL_STRIDE)
    if abs(reached) < np.inf and not leaves_room(world, nobody, start, x, z, reached, ROOM, SPACING):
        return -np.inf
    return reached


@kernel
def _is_roomy(world: World, start: Point, x: float, z: float, height: float) -> bool:
    """Return whether nothing is near the way from a point to a place at a height in m."""
    half = 0.5 * np.sqrt((x - start.x) * (x - start.x) + (z - start.z) * (z - start.z))
    middle = 0.5 * (start.y + height)
    middle_x, middle_z = 0.5 * (start.x + x), 0.5 * (start.z + z)
    if has_room(world, middle_x, middle, middle_z, half + ROOM):
        return True
    # Three bodies as wide as this cover the way, and ROOM beside it.
    wide = BODY_RADIUS + ROOM
    room = np.sqrt(0.25 * half * half + wide * wide) - BODY_RADIUS
    return (
        has_room(world, middle_x, middle, middle_z, room)
        and has_room(world, x, height, z, room)
        and has_room(world, start.x, start.y, start.z, room)
    )


@kernel
def _known_the_other_way(lattice: Lattice, nodes: Nodes, node: int, target: int, direction: int) -> int:
    """Return the node from which an edge leads here that can be walked back, -1 if there is none.

    A way that is free on the ground or on a level floor is so both ways; steps are another matter.
    """
    other = _leads_here(nodes, node, target, direction)
    if other < 0 or abs(nodes.height[other] - nodes.height[node]) <= LEVEL:
        return other
    on_ground = lattice.marks[nodes.point[node]] != FINE and lattice.marks[target] != FINE
    return other if on_ground else -1


@kernel
def _leads_here(nodes: Nodes, node: int, target: int, direction: int) -> int:
    """Return the node over a point from which an edge leads to another, against a direction, or -1."""
    other = int(nodes.first[target])
    while other >= 0 and nodes.edges[other, (direction + DIRECTIONS // 2) % DIRECTIONS] != node:
        other = int(nodes.following[other])
    return other


@kernel
def _edge_over_open_ground(world: World, lattice: Lattice, nodes: Nodes, node: int, target: int) -> int:
    """Return the ground node over a point; FALLS where the ground there, or right behind, drops steeply."""
    if nodes.first[target] >= 0:
        return int(nodes.first[target])
    here_x, here_z = place_of(world, lattice, int(nodes.point[node]))
    x, z = place_of(world, lattice, target)
    behind = ground_at(world, 2.0 * x - here_x, 2.0 * z - here_z).height
    lowest = min(behind, ground_at(world, x, z).height)
    return FALLS if lowest < nodes.height[node] - STEEP_DROP else NO_EDGE


@kernel
def walk_straight(world: World, nobody: Bodies, start: Point, x: float, z: float, stride: float) -> float:
    """Walk straight to a place with the engine's motion.

    Args:
        world: The static world.
        nobody: No bodies.
        start: m.
        x: m, where to.
        z: m.
        stride: m, of each move at most.

    Returns:
        m, the height it arrives at; -inf if it does not, NaN if it walks off an edge or slides on the way.
    """
    at = start
    far = np.sqrt((x - start.x) * (x - start.x) + (z - start.z) * (z - start.z))
    moves = int(np.ceil(far / stride))
    for done in range(moves):
        share = 1.0 / (moves - done)
        way_x, way_z = (x - at.x) * share, (z - at.z) * share
        moved = walk(world, nobody, at, way_x, way_z)
        short = abs(moved.x - at.x - way_x) + abs(moved.z - at.z - way_z)
        at = Point(moved.x, moved.y, moved.z)
        if short > ARRIVAL:
            return -np.inf
        if not moved.on_ground or on_steep_ground(world, at):
            return np.nan
    return at.y


@kernel
def leaves_room(
    world: World, nobody: Bodies, start: Point, x: float, z: float, height: float, room: float, stride: float
) -> bool:
    """Return whether a straight walk arrives about as high if it runs ``room`` m to the left or right."""
    east, north = x - start.x, z - start.z
    share = room / np.sqrt(east * east + north * north)
    for side in (-share, share):
        beside = Point(start.x - side * north, start.y, start.z + side * east)
        reached = walk_straight(world, nobody, beside, x - side * north, z + side * east, stride)
        if not abs(reached - height) <= A_STEP:
            return False
    return True
