"""Shortest paths between places of a map, and their lengths."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.segments import nearest_on
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import NO_BODIES, walk_straight
from wildscav_engine.maps.walk.graph import NavGraph
from wildscav_engine.maps.walk.lattice import SAME_SURFACE, SPACING, level_distance
from wildscav_engine.maps.walk.search import LEG_STRIDE, is_straight, pull_straight, shortest_route
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

    Each of them can be reached by a straight walk from the one before. The ends do not move.
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
    old = level_distance(before, here) + level_distance(here, after)
    foot_x, foot_z = nearest_on((before.x, before.z, after.x, after.z), here.x, here.z)
    whole = level_distance(here, Point(foot_x, here.y, foot_z))
    for share in SHARES:
        moved = share * whole - CORNER_CLEARANCE
        if moved <= 0.0:
            break
        x, z = here.x + share * (foot_x - here.x), here.z + share * (foot_z - here.z)
        if not _turn_at(world, nobody, before, after, x, z).y < np.inf:
            continue
        less = moved / whole
        x, z = here.x + less * (foot_x - here.x), here.z + less * (foot_z - here.z)
        there = _turn_at(world, nobody, before, after, x, z)
        gain = old - level_distance(before, there) - level_distance(there, after)
        if there.y < np.inf and gain > 0.0:
            turns[turn, 0], turns[turn, 1], turns[turn, 2] = there.x, there.y, there.z
            return gain
    return 0.0


@kernel
def _turn_at(world: World, nobody: Bodies, before: Point, after: Point, x: float, z: float) -> Point:
    """Return the turn of a path moved to a place; its height is inf if it cannot be there."""
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
    route = shortest_route(places, graph.network, first, last)
    if len(route) == 0:
        return None
    is_leap = (graph.nodes.edges[route[:-1]] != route[1:, None]).all(axis=1).tolist()
    if not _is_at(start, places[first]):
        places = np.concatenate([places, [start]])
        route, is_leap = np.insert(route, 0, len(places) - 1), [False, *is_leap]
    if not _is_at(end, places[last]):
        places = np.concatenate([places, [end]])
        route, is_leap = np.append(route, len(places) - 1), [*is_leap, False]
    legs = _legs(graph, places, route.astype(np.int32), is_leap, straight)
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
    return len(shortest_route(graph.positions(), graph.network, node, anywhere)) > 0


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
        if abs(there.y - y) <= ATTACH:
            height = walk_straight(graph.world, NO_BODIES, start, end.x, end.z, SPACING)
            if abs(height - end.y) <= SAME_SURFACE:
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


def _legs(
    graph: NavGraph,
    places: NDArray[np.float64],
    route: NDArray[np.int32],
    is_leap: list[bool],
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
    while True:
        kept = pull_straight(graph.world, NO_BODIES, places, route)
        if len(kept) == len(route):
            break
        route = kept
    turns = pull_tight(graph.world, NO_BODIES, places[route])
    kept = pull_straight(graph.world, NO_BODIES, turns, np.arange(len(turns), dtype=np.int32))
    return np.asarray(turns[kept])


def _begins_with_jump(graph: NavGraph, start: int, end: int) -> bool:
    """Return whether the leap between two nodes begins with a jump."""
    leaps = slice(graph.leap_start[start], graph.leap_start[start + 1])
    return bool(graph.leap_jump[leaps][graph.leap_end[leaps] == end].all())


def _is_at(place: Place, node: NDArray[np.float64]) -> bool:
    return all(abs(float(value) - other) <= ON_NODE for value, other in zip(place, node, strict=True))


def _triple(place: Place) -> tuple[float, float, float]:
    return float(place[0]), float(place[1]), float(place[2])
