"""Shortest paths between places of a map, and their lengths."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import walk_straight
from wildscav_engine.maps.walk.graph import NavGraph
from wildscav_engine.maps.walk.lattice import SAME_SURFACE, SPACING
from wildscav_engine.maps.walk.search import LEG_STRIDE, is_edge, is_straight, pull_straight, shortest_route
from wildscav_engine.motion.collision import Bodies, Point

ROUNDS = 8
LEAST_GAIN = 0.01  # m, a round that shortens the path by less is the last
# m that a turn stays away from its limit, because bodies reach it only to a centimetre
CORNER_CLEARANCE = 0.03
SHARES = (1.0, 0.5, 0.25, 0.125)  # of the distance to the straight line, tried in turn
ATTACH = 1.5  # m, greatest distance of a place from the node that represents it
ON_NODE = 1e-6  # m
Place = Sequence[float] | NDArray[np.float64]  # x, y, z in m, soles


@array_kernel
def pull_tight(world: World, nobody: Bodies, turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of a walk, (P, 3) m, with each turn moved towards the line between its neighbours.

    Args:
        turns: (P, 3) m, soles; each can be reached by a straight walk from the one before. The ends do not
            move.
    """
    tight = turns.copy()
    for _ in range(ROUNDS):
        gained = 0.0
        for turn in range(1, tight.shape[0] - 1):
            gained += _move_in(world, nobody, tight, turn)
        if gained < LEAST_GAIN:
            break
    return tight


@kernel
def _move_in(world: World, nobody: Bodies, turns: NDArray[np.float64], turn: int) -> float:
    """Move a turn as far as possible in one step; return how many m shorter the path becomes."""
    before, here, after = _point(turns, turn - 1), _point(turns, turn), _point(turns, turn + 1)
    old = _level_distance(before, here) + _level_distance(here, after)
    foot_x, foot_z = _nearest_on(before, after, here)
    whole = _level_distance(here, Point(foot_x, here.y, foot_z))
    for share in SHARES:
        moved = share * whole - CORNER_CLEARANCE
        if moved <= 0.0:
            break
        furthest = _turn_at(world, nobody, before, here, after, foot_x, foot_z, share)
        if not furthest.y < np.inf:
            continue
        there = _turn_at(world, nobody, before, here, after, foot_x, foot_z, moved / whole)
        gain = old - _level_distance(before, there) - _level_distance(there, after)
        if there.y < np.inf and gain > 0.0:
            turns[turn, 0], turns[turn, 1], turns[turn, 2] = there.x, there.y, there.z
            return gain
    return 0.0


@kernel
def _turn_at(
    world: World,
    nobody: Bodies,
    before: Point,
    here: Point,
    after: Point,
    foot_x: float,
    foot_z: float,
    share: float,
) -> Point:
    """Return a turn moved towards a foot point by a share of the distance; its height is inf if it cannot."""
    x, z = here.x + share * (foot_x - here.x), here.z + share * (foot_z - here.z)
    if max(abs(x - before.x), abs(z - before.z)) < LEG_STRIDE:
        return Point(x, np.inf, z)
    height = walk_straight(world, nobody, before, x, z, SPACING)
    if not abs(height) < np.inf:
        return Point(x, np.inf, z)
    there = Point(x, height, z)
    if is_straight(world, nobody, before, there) and is_straight(world, nobody, there, after):
        return there
    return Point(x, np.inf, z)


@kernel
def _point(turns: NDArray[np.float64], turn: int) -> Point:
    return Point(turns[turn, 0], turns[turn, 1], turns[turn, 2])


@kernel
def _level_distance(one: Point, other: Point) -> float:
    """Return the horizontal distance in m between two points."""
    return float(np.sqrt((other.x - one.x) * (other.x - one.x) + (other.z - one.z) * (other.z - one.z)))


@kernel
def _nearest_on(start: Point, end: Point, here: Point) -> tuple[float, float]:
    """Return x and z in m of the point between two others that is nearest to a third, seen from above."""
    east, north = end.x - start.x, end.z - start.z
    length = east * east + north * north
    share = ((here.x - start.x) * east + (here.z - start.z) * north) / length if length > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    return start.x + share * east, start.z + share * north


class Leg(NamedTuple):
    """A straight part of a path."""

    end: tuple[float, float, float]  # m, soles
    leap: bool = False  # whether it gets down or up: go at LEAP_SPEED
    jump: bool = False  # whether to jump at the start; only in a leap


@dataclass(frozen=True)
class Path:
    """A path that the engine's motion can follow, straight from point to point."""

    start: tuple[float, float, float]  # m, soles
    legs: tuple[Leg, ...]

    @property
    def points(self) -> NDArray[np.float64]:
        """(P, 3) m, the start and the end of every leg."""
        return np.array([self.start, *(leg.end for leg in self.legs)])

    @property
    def length(self) -> float:
        """In m, horizontal, as a seat's ``walked`` counts it."""
        offsets = np.diff(self.points[:, ::2], axis=0)
        return float(np.sqrt(offsets[:, 0] * offsets[:, 0] + offsets[:, 1] * offsets[:, 1]).sum())


def find_path(graph: NavGraph, start: Place, end: Place, *, straight: bool = True) -> Path | None:
    """Return the shortest known path between two places of a map.

    The shortest route over the graph is straightened wherever a straight walk also arrives, and its turns are
    moved close to the corners. A shorter path may exist through a gap so narrow that it lies between the
    graph's nodes; no path that stays 0.25 m away from everything is more than 2 % shorter.

    Args:
        graph: Of the map.
        start: x, y, z in m, soles.
        end: The same.
        straight: Whether to straighten it. A path that goes from node to node keeps more distance from walls.

    Returns:
        The path; None if there is none, or if no body can stand at one of the places.
    """
    first, last = node_near(graph, start, leave=True), node_near(graph, end, leave=False)
    if first is None or last is None:
        return None
    places = graph.positions()
    route = shortest_route(places, graph.nodes.edges, graph.leap_start, graph.leap_end, first, last)
    if len(route) == 0:
        return None
    is_leap = [
        not is_edge(graph.nodes.edges, int(route[at]), int(route[at + 1])) for at in range(len(route) - 1)
    ]
    if not _is_at(start, places[first]):
        places = np.concatenate([places, [start]])
        route, is_leap = np.insert(route, 0, len(places) - 1), [False, *is_leap]
    if not _is_at(end, places[last]):
        places = np.concatenate([places, [end]])
        route, is_leap = np.append(route, len(places) - 1), [*is_leap, False]
    legs = _legs(graph, places, route.astype(np.int32), is_leap, straight=straight)
    return Path(_triple(start), tuple(legs))


def is_reached(graph: NavGraph, place: Place, distance: float) -> bool:
    """Return whether a place (or a point within a distance in m of it) can be reached from all over the map.

    Args:
        graph: Of the map.
        place: x, y, z in m, soles.
        distance: m, 3D.
    """
    node = node_near(graph, place, leave=False)
    if node is not None and graph.connected[node]:
        return True
    offsets = graph.positions(np.nonzero(graph.connected)[0]) - np.asarray(place, np.float64)
    return bool(((offsets * offsets).sum(axis=1) <= distance * distance).any())


def leads_out(graph: NavGraph, place: Place) -> bool:
    """Return whether all of the map can be reached from a place (x, y, z in m, soles)."""
    node = node_near(graph, place, leave=True)
    if node is None or graph.connected[node]:
        return node is not None
    anywhere = int(np.argmax(graph.connected))
    tables = graph.nodes.edges, graph.leap_start, graph.leap_end
    return len(shortest_route(graph.positions(), *tables, node, anywhere)) > 0


def node_near(graph: NavGraph, place: Place, *, leave: bool) -> int | None:
    """Return the nearest node connected to a place by a straight walk, or None.

    Args:
        graph: Of the map.
        place: x, y, z in m, soles.
        leave: Whether to walk from the place to the node, else from the node to the place.
    """
    x, y, z = (float(value) for value in place)
    nodes = _nodes_around(graph, x, z)
    places = graph.positions(nodes)
    offsets = places - (x, y, z)
    for index in np.argsort((offsets * offsets).sum(axis=1), kind="stable"):
        here, there = Point(x, y, z), Point(*places[index])
        start, end = (here, there) if leave else (there, here)
        if abs(there.y - y) <= ATTACH and _leads_to(graph, start, end):
            return int(nodes[index])
    return None


def _nodes_around(graph: NavGraph, x: float, z: float) -> NDArray[np.int64]:
    """Return all nodes over the lattice points within ATTACH of a place."""
    column, row = (x - graph.world.corner[0]) / SPACING, (z - graph.world.corner[1]) / SPACING
    reach, side = ATTACH / SPACING, graph.lattice.side
    found = []
    for near_row in range(max(0, int(row - reach) + 1), min(side, int(row + reach) + 1)):
        for near_column in range(max(0, int(column - reach) + 1), min(side, int(column + reach) + 1)):
            node = int(graph.nodes.first[near_row * side + near_column])
            while node >= 0:
                found.append(node)
                node = int(graph.nodes.following[node])
    return np.array(found, np.int64)


def _leads_to(graph: NavGraph, start: Point, end: Point) -> bool:
    nobody = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)
    height = walk_straight(graph.world, nobody, start, end.x, end.z, SPACING)
    return bool(abs(height - end.y) <= SAME_SURFACE)


def _legs(
    graph: NavGraph,
    places: NDArray[np.float64],
    route: NDArray[np.int32],
    is_leap: Sequence[bool],
    *,
    straight: bool,
) -> list[Leg]:
    """Return the legs along a route: its leaps unchanged, the walks between them straightened if asked."""
    legs = []
    first = 0
    for at, leaps in enumerate([*is_leap, True]):
        if leaps:
            walked = route[first : at + 1]
            turns = pulled(graph, places, walked) if straight else places[walked]
            legs += [Leg(_triple(turn)) for turn in turns[1:]]
            first = at + 1
            if first < len(route):
                jump = _begins_with_jump(graph, int(route[at]), int(route[first]))
                legs.append(Leg(_triple(places[route[first]]), True, jump))
    return legs


def pulled(graph: NavGraph, places: NDArray[np.float64], route: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return (P, 3) m the turns of a walk after it is pulled straight and tight."""
    nobody = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)
    while True:
        kept = pull_straight(graph.world, nobody, places, route)
        if len(kept) == len(route):
            break
        route = kept
    turns = pull_tight(graph.world, nobody, places[route])
    kept = pull_straight(graph.world, nobody, turns, np.arange(len(turns), dtype=np.int32))
    return np.asarray(turns[kept])


def _begins_with_jump(graph: NavGraph, start: int, end: int) -> bool:
    """Return whether the leap between two nodes begins with a jump."""
    leaps = slice(graph.leap_start[start], graph.leap_start[start + 1])
    return bool(graph.leap_jump[leaps][graph.leap_end[leaps] == end].all())


def _is_at(place: Place, node: NDArray[np.float64]) -> bool:
    return all(abs(float(value) - other) <= ON_NODE for value, other in zip(place, node, strict=True))


def _triple(place: Place) -> tuple[float, float, float]:
    return float(place[0]), float(place[1]), float(place[2])
