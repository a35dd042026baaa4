"""Ways over the surfaces that an agent has seen: to places, or to where it has not looked yet."""

import heapq
import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from wildscav.agent import Vector
from wildscav.geometry import flat_distance
from wildscav.skills.surroundings import CELL, Surroundings, Window

STEP = 2  # voxels that an agent can walk up and down
BODY = 0b1111100  # voxels above the floor's own that must be free in a column to stand in it
SHOULDERS = 0b1110000  # voxels above the floor's own that must be free beside it
HEAD = 8  # voxels from a floor to above the head of an agent
UNSEEN_COST = 0.2  # m, added for each column whose floor was not seen
TIGHT_COST = 0.4  # m, added for each column at a corner
FALL_COST = 2.0  # m; falls do no harm, but there may be no way back
STOREY_COST = 4.0  # m on foot for each metre between a place and a box above or below
ROOF_COST = 80.0  # m, for ending a part of a way inside a building
SQUEEZE = 1.0  # m from the start within which a way may touch walls, because agents do
NEAR = 1.0  # m; from here a box can be picked up
MAX_COLUMNS = 3000  # columns visited by one search

Node = int  # 64 times the column's index in the window, plus the voxel of the floor


class Way(NamedTuple):
    """A way on foot."""

    points: tuple[Vector, ...]  # m, a column apart
    length: float  # m, with what was added for risks


class Ways(NamedTuple):
    """What a search found."""

    to: dict[int, Way]  # by the key of the goal
    unseen: Way | None  # to a place where nothing has been seen, towards one of the hints
    toward: Way | None  # part of the way to a place far away


def find_ways(
    surroundings: Surroundings,
    here: Vector,
    goals: Mapping[int, Vector],
    reach: float,
    *,
    enough: float = math.inf,
    hints: Iterable[Vector] = (),
    far: Vector | None = None,
) -> Ways:
    """Return the shortest known ways from a place to goals (Dijkstra 1959; towards ``far``, A*).

    Columns whose floor was not seen are taken to be level, at an additional cost.

    Args:
        goals: Places by a key; to be within 1 m of one is enough.
        reach: Metres to each side that are searched.
        enough: Metres beyond the first goal at which the search may end.
        hints: Places to which unseen places may lead.
        far: A place, perhaps out of reach, to which a part of the way is wanted.
    """
    search = _Search(surroundings, here, reach)
    found = search.run(_columns_near(search.window, surroundings.half, goals, here, reach), enough, far)
    return Ways(
        {key: search.way(node) for key, node in found.items()},
        search.best_unseen(tuple(hints)),
        None if far is None else search.best_toward(far),
    )


def _floor_offset(column: int) -> int | None:
    """Return the floor walked to from bit 2 of a column's 11 bits, relative to it; None if blocked."""
    for floor in range(2 * STEP, -1, -1):
        if column >> floor & 1 and not column & (BODY << floor):
            return floor - STEP
    return None


OFFSETS = tuple(_floor_offset(column) for column in range(1 << 11))


class _Search:
    """One search, with what it has found so far."""

    def __init__(self, surroundings: Surroundings, here: Vector, reach: float) -> None:
        self.half = surroundings.half
        self.window: Window = surroundings.window(here, reach)
        self.start: Node = 64 * self.window.index_of(here, self.half) + self.window.voxel_of(here[1])
        self.costs: dict[Node, float] = {self.start: 0.0}
        self.before: dict[Node, Node] = {}
        self.visited: set[Node] = set()
        self.unseen: list[Node] = []
        width = self.window.width
        diagonal = CELL * math.sqrt(2.0)
        self.moves = [(step, CELL) for step in (1, -1, width, -width)]
        self.moves += [(step, diagonal) for step in (width + 1, width - 1, 1 - width, -width - 1)]

    def run(
        self, goals: dict[int, list[tuple[int, int]]], enough: float, far: Vector | None
    ) -> dict[int, Node]:
        """Search until all columns were visited, or ``enough`` metres beyond the first goal.

        The goals are keys and voxels by column. The search goes towards ``far`` first.
        """
        open_nodes = [(0.0, 0.0, self.start)]
        found: dict[int, Node] = {}
        limit = math.inf
        while open_nodes and len(self.visited) < MAX_COLUMNS:
            _, cost, node = heapq.heappop(open_nodes)
            if cost > limit:
                break
            if node in self.visited:
                continue
            self.visited.add(node)
            index, floor = divmod(node, 64)
            for key, voxel in goals.get(index, ()):
                if key not in found and -3 <= voxel - floor <= 3:
                    found[key] = node
                    limit = min(limit, cost + enough)
            if node != self.start and not self.window.around[index] >> (floor - STEP) & 0b11111:
                self.unseen.append(node)
            else:
                self._expand(node, cost, far, open_nodes)
        return found

    def _expand(
        self, node: Node, cost: float, far: Vector | None, open_nodes: list[tuple[float, float, Node]]
    ) -> None:
        """Add the nodes that can be walked to from one."""
        own, beside, around = self.window.own, self.window.beside, self.window.around
        index, voxel = divmod(node, 64)
        if self.window.is_edge(index):
            return
        squeezes, costs = cost < SQUEEZE, self.costs
        for step, length in self.moves:
            other = index + step
            column = own[other]
            shifted = column >> (voxel - STEP)
            floor, new = voxel, cost + length
            if shifted & 0x7FF:
                offset = OFFSETS[shifted & 0x7FF]
                if offset is None:
                    continue
                floor = max(voxel + offset, STEP)
            elif column & ((1 << voxel) - 1):
                floor = max((column & ((1 << voxel) - 1)).bit_length() - 1, STEP)
                new += FALL_COST
            else:
                new += UNSEEN_COST
            shoulders = SHOULDERS << floor
            if around[other] & shoulders:
                if beside[other] & shoulders and not squeezes:
                    continue
                new += TIGHT_COST
            neighbour = 64 * other + floor
            if new < costs.get(neighbour, math.inf):
                costs[neighbour], self.before[neighbour] = new, node
                rest = 0.0 if far is None else self._rest(other, far)
                heapq.heappush(open_nodes, (new + rest, new, neighbour))

    def best_unseen(self, hints: tuple[Vector, ...]) -> Way | None:
        """Return the way to the unseen place from which it is nearest to a hint, or None."""
        best, least = None, math.inf
        for node in self.unseen if hints else ():
            place = self.window.place_of(*divmod(node, 64), self.half)
            rest = min(flat_distance(place, hint) + STOREY_COST * abs(place[1] - hint[1]) for hint in hints)
            if self.costs[node] + rest < least:
                best, least = node, self.costs[node] + rest
        return None if best is None else self.way(best)

    def best_toward(self, far: Vector) -> Way:
        """Return the way to the visited place nearest to another one, outside of buildings if possible."""

        def cost(node: Node) -> float:
            index, floor = divmod(node, 64)
            roof = ROOF_COST if self.window.own[index] >> (floor + HEAD) else 0.0
            return 2.0 * self._rest(index, far) + self.costs[node] + roof

        return self.way(min(self.visited, key=cost))

    def _rest(self, index: int, far: Vector) -> float:
        """Return the straight distance from a column to a place, m."""
        north, east = divmod(index, self.window.width)
        x, z = (self.window.west + east) * CELL - self.half, (self.window.south + north) * CELL - self.half
        return math.hypot(far[0] - x, far[2] - z)

    def way(self, node: Node) -> Way:
        """Return the way to a node."""
        points = [node]
        while points[-1] in self.before:
            points.append(self.before[points[-1]])
        places = tuple(self.window.place_of(*divmod(point, 64), self.half) for point in reversed(points))
        return Way(places, self.costs[node])


def _columns_near(
    window: Window, half: float, goals: Mapping[int, Vector], here: Vector, reach: float
) -> dict[int, list[tuple[int, int]]]:
    """Return the keys and voxels of the goals that are near enough to each column."""
    found: dict[int, list[tuple[int, int]]] = {}
    cells = int(NEAR / CELL)
    for key, place in goals.items():
        if max(abs(place[0] - here[0]), abs(place[2] - here[2])) > reach - 2.0 * NEAR:
            continue
        middle, voxel = window.index_of(place, half), window.voxel_of(place[1])
        for north in range(-cells, cells + 1):
            for east in range(-cells, cells + 1):
                if math.hypot(east, north) * CELL < NEAR:
                    found.setdefault(middle + north * window.width + east, []).append((key, voxel))
    return found
