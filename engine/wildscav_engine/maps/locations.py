"""The places where agents and supplies may be: nodes of the walkable graph that are mutually reachable."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Stream, uniform, uniform_in
from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.walk import NavGraph
from wildscav_engine.maps.walk.lattice import FINE

STREAM = int(Stream.LOCATIONS)
OUTDOOR_SPACING = 4.0  # m, of the jittered grid of places on the ground
STEEPEST_PLACE = 0.7002075382097097  # m up per m: 35°
AREA_OF_PLACE = 5.0  # m² of a room for each place in it
INDOOR_SPACING = 1.5  # m, least distance between places in a room
HIGH_SPACING = 4.0  # m, least distance between places on roofs and rocks
ON_GROUND = 0.05  # m above the terrain that still count as on it
ON_FLOOR = 0.1  # m above or below a floor that still count as on it
TRUNK, CROWN, BUSH = int(Kind.TRUNK), int(Kind.CROWN), int(Kind.BUSH)
CEILING = 8.0  # m above a place; a solid within this makes the place indoor


class Places(NamedTuple):
    """All places of a map, each (N, 3) m, soles."""

    ground: NDArray[np.float64]  # on open, dry, fairly level ground
    high: NDArray[np.float64]  # in the open, on roofs, rocks and the like
    indoor: NDArray[np.float64]


def choose_places(
    graph: NavGraph, houses: Sequence[House], solid_house: NDArray[np.int16], seed: int
) -> Places:
    """Choose the places of a map among the nodes of its graph's largest strongly connected component."""
    nodes, positions = np.nonzero(graph.connected)[0], graph.positions()
    is_on_ground = _on_open_ground(graph, nodes, positions, solid_house)
    whole = _on_whole_metres(graph, nodes[is_on_ground])
    ground = ground_places(graph.world, _lookup(graph, whole), positions, np.uint64(seed))
    above = nodes[~is_on_ground]
    places = positions[above]
    draws = _draws(np.uint64(seed), above)
    indoor, taken = _in_rooms(houses, places, draws)
    rest = np.nonzero(~taken)[0]
    covered = is_covered(graph.world, places[rest], np.arange(len(solid_house)))
    inside = _away_from(indoor, _spaced(places[rest[covered]], draws[rest[covered]], INDOOR_SPACING))
    high = _spaced(places[rest[~covered]], draws[rest[~covered]], HIGH_SPACING)
    return Places(ground, high, np.concatenate([indoor, inside]))


def open_ground(graph: NavGraph, solid_house: NDArray[np.int16]) -> NDArray[np.float64]:
    """Return (N, 3) m all reachable whole-metre points on dry, fairly level, open ground."""
    nodes, positions = np.nonzero(graph.connected)[0], graph.positions()
    nodes = _on_whole_metres(graph, nodes[_on_open_ground(graph, nodes, positions, solid_house)])
    places = positions[nodes]
    return np.asarray(places[_are_places(graph.world, places)])


def _on_open_ground(
    graph: NavGraph, nodes: NDArray[np.int64], positions: NDArray[np.float64], solid_house: NDArray[np.int16]
) -> NDArray[np.bool_]:
    """Return (N,) whether each node is on the terrain and not under a roof, except the eaves of a house."""
    is_on_ground = stand_on_ground(graph.world, positions, nodes)
    # Under any roof but the eaves of a house, the bare ground counts as a floor.
    near_solids = is_on_ground & (graph.lattice.marks[graph.nodes.point[nodes]] == FINE)
    roofs = np.nonzero(solid_house < 0)[0]
    is_on_ground[near_solids] = ~is_covered(graph.world, positions[nodes[near_solids]], roofs)
    return is_on_ground


@array_kernel
def stand_on_ground(world: World, places: NDArray[np.float64], nodes: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (N,) for some nodes whether they are on the terrain."""
    on_ground = np.empty(len(nodes), np.bool_)
    for index in range(len(nodes)):
        place = places[nodes[index]]
        on_ground[index] = place[1] <= ground_at(world, place[0], place[2]).height + ON_GROUND
    return on_ground


def _on_whole_metres(graph: NavGraph, nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    point = graph.nodes.point[nodes]
    return np.asarray(nodes[(point // graph.lattice.side % 2 == 0) & (point % graph.lattice.side % 2 == 0)])


def _lookup(graph: NavGraph, nodes: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return (M, M) the node at each whole-metre point of the map, row after row northwards, -1 for none."""
    side = graph.lattice.side
    found = np.full((side // 2 + 1, side // 2 + 1), -1, np.int32)
    found[graph.nodes.point[nodes] // side // 2, graph.nodes.point[nodes] % side // 2] = nodes
    return found


@array_kernel
def ground_places(
    world: World, nodes: NDArray[np.int32], positions: NDArray[np.float64], seed: np.uint64
) -> NDArray[np.float64]:
    """Return (N, 3) m, places on dry, fairly level, open ground: a random node in each square of a grid.

    Args:
        nodes: (M, M) the ground node at each whole-metre point, -1 for none.
        positions: Of all nodes, m.
    """
    squares = int((nodes.shape[0] - 1) / OUTDOOR_SPACING)
    places = np.empty((squares * squares, 3))
    found = 0
    for row in range(squares):
        for column in range(squares):
            east = (column + uniform_in(0.15, 0.85, seed, STREAM, 1, row, 2 * column)) * OUTDOOR_SPACING
            north = (row + uniform_in(0.15, 0.85, seed, STREAM, 1, row, 2 * column + 1)) * OUTDOOR_SPACING
            node = nodes[int(north + 0.5), int(east + 0.5)]
            if node >= 0 and _is_place(world, positions[node]):
                for axis in range(3):
                    places[found, axis] = positions[node, axis]
                found += 1
    return places[:found].copy()


@kernel
def _is_place(world: World, place: NDArray[np.float64]) -> bool:
    """Return whether a place on the ground is dry, fairly level, and clear of solids."""
    ground = ground_at(world, place[0], place[2])
    steepness = ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z
    if steepness > STEEPEST_PLACE * STEEPEST_PLACE or water_at(world, place[0], place[2]) > -np.inf:
        return False
    return is_clear(world, place[0], ground.height, place[2])


@array_kernel
def _are_places(world: World, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) whether each of (N, 3) m on the ground can be a place."""
    found = np.empty(places.shape[0], np.bool_)
    for index in range(places.shape[0]):
        found[index] = _is_place(world, places[index])
    return found


@array_kernel
def _draws(seed: np.uint64, nodes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return (N,) a random number in [0, 1) for each node."""
    draws = np.empty(len(nodes))
    for index in range(len(nodes)):
        draws[index] = uniform(seed, STREAM, 2, 0, nodes[index])
    return draws


def _in_rooms(
    houses: Sequence[House], places: NDArray[np.float64], draws: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Choose places on the floors of all rooms, and mark which of (N, 3) m are inside any house.

    Returns:
        (P, 3) m the chosen places, room after room; (N,) whether each place is inside a storey of a house.
    """
    chosen = [np.zeros((0, 3))]
    taken = np.zeros(len(places), np.bool_)
    for house in houses:
        near = np.nonzero(_is_near(house, places))[0]
        across, along = house.pose.inside(places[near, 0], places[near, 2])
        storey = (places[near, 1] - house.ground) / house.storey_height
        for level, area in house.rooms:
            within = area.holds(across, along)
            in_room = near[within & (storey > level - 0.05) & (storey < level + 0.95)]
            taken[in_room] = True
            off_floor = places[in_room, 1] - house.ground - level * house.storey_height
            on_floor = in_room[np.abs(off_floor) <= ON_FLOOR]
            count = max(1, round(area.area / AREA_OF_PLACE))
            chosen.append(_spaced(places[on_floor], draws[on_floor], INDOOR_SPACING)[:count])
    return np.concatenate(chosen), taken


def houses_cut_off(houses: Sequence[House], indoor: NDArray[np.float64]) -> list[int]:
    """Return the numbers of the houses that have a room without any of the indoor places, (N, 3) m."""
    cut_off = []
    for number, house in enumerate(houses):
        x, y, z = indoor[_is_near(house, indoor)].T
        across, along = house.pose.inside(x, z)
        for level, area in house.rooms:
            within = area.holds(across, along)
            floor = house.ground + level * house.storey_height
            if not (within & (np.abs(y - floor) <= ON_FLOOR)).any():
                cut_off.append(number)
                break
    return cut_off


def _is_near(house: House, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    reach = house.size[0] + house.size[1]
    near_x = np.abs(places[:, 0] - house.center[0]) < reach
    return np.asarray(near_x & (np.abs(places[:, 2] - house.center[1]) < reach))


def _spaced(places: NDArray[np.float64], draws: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return places, picked in the order of their draws, that are at least a distance apart."""
    return keep_apart(places[np.argsort(draws, kind="stable")], spacing)


def _away_from(chosen: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the places that are not near any chosen one, (N, 3) m each."""
    free = np.ones(len(places), np.bool_)
    for place in chosen:
        offsets = places - place
        free &= (offsets * offsets).sum(axis=1) >= INDOOR_SPACING * INDOOR_SPACING
    return places[free]


@array_kernel
def keep_apart(places: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return (M, 3) m the places, in order, that are at least ``spacing`` m from all kept before them."""
    if len(places) == 0:
        return places.copy()
    west, south = east, north = places[0, 0], places[0, 2]
    for place in places:
        west, east = min(west, place[0]), max(east, place[0])
        south, north = min(south, place[2]), max(north, place[2])
    columns, rows = int((east - west) / spacing) + 1, int((north - south) / spacing) + 1
    first = np.full((rows, columns), -1, np.int32)  # linked lists of the kept places in each square
    following = np.empty(len(places), np.int32)
    kept = np.empty_like(places)
    count = 0
    for place in places:
        row, column = int((place[2] - south) / spacing), int((place[0] - west) / spacing)
        if not _is_crowded(kept, first, following, row, column, place, spacing):
            for axis in range(3):
                kept[count, axis] = place[axis]
            following[count], first[row, column] = first[row, column], count
            count += 1
    return kept[:count].copy()


@kernel
def _is_crowded(
    kept: NDArray[np.float64],
    first: NDArray[np.int32],
    following: NDArray[np.int32],
    row: int,
    column: int,
    place: NDArray[np.float64],
    spacing: float,
) -> bool:
    """Return whether a kept place is nearer than ``spacing``; it searches the nine squares around."""
    for near_row in range(max(0, row - 1), min(first.shape[0], row + 2)):
        for near_column in range(max(0, column - 1), min(first.shape[1], column + 2)):
            other = first[near_row, near_column]
            while other >= 0:
                east, up = kept[other, 0] - place[0], kept[other, 1] - place[1]
                north = kept[other, 2] - place[2]
                if east * east + up * up + north * north < spacing * spacing:
                    return True
                other = following[other]
    return False


@array_kernel
def is_covered(world: World, places: NDArray[np.float64], ceilings: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (N,) whether one of the solids ``ceilings`` is over each place in m; plants do not count."""
    counts = np.zeros(len(world.solid_kind), np.bool_)
    counts[ceilings] = True
    covered = np.empty(len(places), np.bool_)
    for index in range(len(places)):
        x, y, z = places[index, 0], places[index, 1] + 1.0, places[index, 2]
        hit = raycast(world, x, y, z, 0.0, 1.0, 0.0, CEILING)
        covered[index] = hit.solid >= 0 and counts[hit.solid] and not is_plant(world.solid_kind[hit.solid])
    return covered


@kernel
def is_plant(kind: int) -> bool:
    """Return whether a kind of solid is part of a plant."""
    return kind in (TRUNK, CROWN, BUSH)
