"""Ways through the columns: straight where nothing is in the way, else the shortest by A*."""

import math
from heapq import heappop, heappush
from typing import NamedTuple

from columns import CELL, JUMP, STEP, Columns, Entered, Vector

SAMPLES = 0.5  # m between the places that are tested along a straight line
BESIDE = 0.4  # m on either side of it that must be free, too
DIAGONAL = math.sqrt(2.0)
NARROW = 0.6  # share by which a step beside an obstacle is dearer
CLIMB = 6.0  # m that a jump is worth
HIGH_STEP = 1.0  # m that the highest step is worth, which may need a jump
DROP = 1.0  # m that a drop of more than so many boxes is worth, from which there may be no way back
DEEP = 4
HURRY = (
    1.1  # factor of the distance left: paths are at most so much longer than the shortest, and found sooner
)
MOST = 20000  # nodes that a search looks at
SAME_FLOOR = 4  # boxes above or below the target, where a path may end
UNKNOWN = 1023  # in the key of a node whose floor was not seen
LEVELS = 1024


class Node(NamedTuple):
    """A place of a path."""

    cell: int
    height: int  # boxes
    is_known: bool


def is_straight(columns: Columns, start: Vector, goal: tuple[float, float], height: int | None) -> bool:
    """Return whether a body can walk straight from a place to another.

    Args:
        columns: What was seen.
        start: m, soles.
        goal: x and z, m.
        height: Of the goal's floor, boxes; None: any.
    """
    east, north = goal[0] - start[0], goal[1] - start[2]
    length = math.hypot(east, north)
    if length < CELL:
        return height is None or abs(columns.level(start[1]) - height) <= SAME_FLOOR
    side_x, side_z = -north / length * BESIDE, east / length * BESIDE
    floor, known = columns.level(start[1]), True
    count = math.ceil(length / SAMPLES)
    enter, cell_of = columns.enter, columns.cell
    for number in range(1, count + 1):
        x, z = start[0] + east * number / count, start[2] + north * number / count
        entered = enter(cell_of(x, z), floor, known)
        if entered is None or (known and entered.height > floor + STEP) or entered.height < floor - 8:
            return False
        if number > 1 and number < count:
            for side in (1.0, -1.0):
                beside = enter(cell_of(x + side * side_x, z + side * side_z), floor, known)
                if beside is None or (known and beside.is_known and beside.height > floor + STEP):
                    return False
        floor, known = entered
    return height is None or not known or abs(floor - height) <= SAME_FLOOR


def find_way(columns: Columns, start: Vector, target: Vector) -> tuple[list[Node], int]:
    """Return the places of the shortest way that was found, from the start on, and how many were looked at.

    If no way leads to the target, it ends at the place nearest to it.
    """
    search = Search(columns, start, target)
    return search.way(), len(search.closed)


class Search:
    """A* over cells and floors. Floors of a cell that were not seen are one node, however it is reached."""

    def __init__(self, columns: Columns, start: Vector, target: Vector) -> None:
        self.columns, self.side = columns, columns.side
        goal, self.goal_height = columns.cell(target[0], target[2]), columns.level(target[1])
        self.goal_row, self.goal_column = divmod(goal, self.side)
        # In cells from the target, where a way may end.
        self.near = 0 if columns.enter(goal, self.goal_height, was_known=True) else 1
        self.straight = (1, -1, self.side, -self.side)
        first = Node(columns.cell(start[0], start[2]), columns.level(start[1]), is_known=True)
        self.first = first.cell * LEVELS + first.height
        self.nodes = {self.first: first}
        self.cost = {self.first: 0.0}  # in cells
        self.came: dict[int, int] = {}
        self.closed: set[int] = set()
        self.queue: list[tuple[float, float, int]] = [(0.0, 0.0, self.first)]

    def way(self) -> list[Node]:
        """Return the places of the way."""
        key = self._last()
        way = [self.nodes[key]]
        while key in self.came:
            key = self.came[key]
            way.append(self.nodes[key])
        way.reverse()
        return way

    def _last(self) -> int:
        """Search, and return the node at the target, or the nearest to it."""
        nearest, nearest_left = self.first, math.inf
        while self.queue and len(self.closed) < MOST:
            key = heappop(self.queue)[2]
            if key in self.closed:
                continue
            self.closed.add(key)
            cell, height, known = node = self.nodes[key]
            rows, columns = self._offset(cell)
            off = max(abs(height - self.goal_height) - SAME_FLOOR, 0) if known else 0
            if rows <= self.near and columns <= self.near and off == 0:
                return key
            left = math.hypot(rows, columns) + off
            if left < nearest_left:
                nearest, nearest_left = key, left
            self._expand(key, node)
        return nearest

    def _offset(self, cell: int) -> tuple[int, int]:
        """Return how many rows and columns a cell is away from the target."""
        row, column = divmod(cell, self.side)
        return abs(row - self.goal_row), abs(column - self.goal_column)

    def _expand(self, key: int, node: Node) -> None:
        """Queue the nodes around a node."""
        free = self._free_around(node)
        dear = 1.0 if len(free) == len(self.straight) + len(self._diagonal()) else 1.0 + NARROW
        here = self.cost[key]
        for step, entered in free.items():
            length = 1.0 if step in self.straight else DIAGONAL
            total = here + (length * dear + _extra(node, entered) / CELL)
            cell = node.cell + step
            reached = cell * LEVELS + (entered.height if entered.is_known else UNKNOWN)
            if total < self.cost.get(reached, math.inf) and reached not in self.closed:
                self.cost[reached], self.came[reached] = total, key
                self.nodes[reached] = Node(cell, *entered)
                rows, columns = self._offset(cell)
                guess = max(rows, columns) + (DIAGONAL - 1.0) * min(rows, columns)
                heappush(self.queue, (total + HURRY * guess, -total, reached))

    def _diagonal(self) -> tuple[tuple[int, int], ...]:
        side = self.side
        return (1, side), (1, -side), (-1, side), (-1, -side)

    def _free_around(self, node: Node) -> dict[int, Entered]:
        """Return the cells around a node that can be entered; diagonally only past two others."""
        cell, height, known = node
        enter = self.columns.enter
        free: dict[int, Entered] = {}
        for step in self.straight:
            entered = enter(cell + step, height, known)
            if entered is not None:
                free[step] = entered
        for one, other in self._diagonal():
            if one in free and other in free:
                entered = enter(cell + one + other, height, known)
                if entered is not None:
                    free[one + other] = entered
        return free


def _extra(node: Node, entered: Entered) -> float:
    """Return what a step up or down costs in addition to its length, m."""
    if not entered.is_known:
        return 0.0
    rise = entered.height - node.height
    if not node.is_known:
        return CLIMB if rise > JUMP else 0.0
    if rise > STEP:
        return CLIMB
    if rise == STEP:
        return HIGH_STEP
    return DROP if rise < -DEEP else 0.0


def is_free(columns: Columns, way: list[Node], first: int) -> bool:
    """Return whether a way can still be walked from one of its places on."""
    for before, after in zip(way[first:], way[first + 1 :], strict=False):
        entered = columns.enter(after.cell, before.height, before.is_known)
        if entered is None:
            return False
        if entered.is_known and (entered.height > before.height + JUMP and before.is_known):
            return False
        if after.is_known and entered.height != after.height:
            return False
    return True
