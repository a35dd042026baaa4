"""Wards: the map divided into irregular quadrangles, with borders of which few have a way through."""

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.specs.map_spec import Country

JITTER = 0.2  # of a ward's side, by which its corners are moved; up to 0.25 all wards stay convex
WINDING = 0.7  # chance that a way goes on from the ward reached last, so that ways are long
GATE_RANGE = (0.25, 0.75)  # of a border's length, where a way through may be
WARDS_OF_REGION = 7  # that are of one kind, approximately
LEVELS = 3  # of terraces
LEVEL_HEIGHT = 4.2  # m from one level to the next


class Barrier(IntEnum):
    """What stands on a border."""

    WALL = 0
    THICKET = 1
    RIDGE = 2
    CLIFF = 3  # between two levels of terraces
    TOWN_WALL = 4


class Border(NamedTuple):
    """The border between two wards."""

    start: tuple[float, float]  # m, x and z
    end: tuple[float, float]
    wards: tuple[int, int]  # left and right of the direction from start to end
    barrier: Barrier
    gate: float | None  # m from the start to the middle of the way through; None: closed

    @property
    def length(self) -> float:
        """In m."""
        east, north = self.end[0] - self.start[0], self.end[1] - self.start[1]
        return float(np.sqrt(east * east + north * north))

    @property
    def direction(self) -> tuple[float, float]:
        """The unit vector from start to end, x and z."""
        east, north, length = self.end[0] - self.start[0], self.end[1] - self.start[1], self.length
        return east / length, north / length

    def at(self, along: float, aside: float = 0.0) -> tuple[float, float]:
        """Return x and z of a point ``along`` m from the start and ``aside`` m to the right."""
        east, north = self.direction
        return self.start[0] + along * east + aside * north, self.start[1] + along * north - aside * east

    def spans(self, width: float) -> list[tuple[float, float]]:
        """Return the parts of it, in m from the start, that a way of a width in m leaves."""
        if self.gate is None:
            return [(0.0, self.length)]
        return [(0.0, self.gate - width / 2.0), (self.gate + width / 2.0, self.length)]


class Block(NamedTuple):
    """A square of a town, in cells of the grid of wards."""

    row: int
    column: int
    side: int  # cells


class Wards(NamedTuple):
    """The wards of a map: a grid of N by N cells. A town takes a block of them, and counts as one ward."""

    corners: NDArray[np.float64]  # (N + 1, N + 1, 2) m, x and z, row after row northwards
    numbers: NDArray[np.int64]  # (N, N) the ward of each cell
    kinds: tuple[Barrier, ...]  # of each ward: what stands on borders within its region
    levels: NDArray[np.float64]  # (N * N,) m by which the ground of each ward is raised
    borders: tuple[Border, ...]

    @property
    def ways(self) -> NDArray[np.int64]:
        """(N * N,) the number of ways out of each ward; a dead end has one."""
        ends = [number for border in self.borders if border.gate is not None for number in border.wards]
        return np.bincount(np.array(ends, np.int64), minlength=self.numbers.size)


def grid_of(size: int, country: Country) -> tuple[int, float]:
    """Return how many wards there are along a side of the map, and their side in m."""
    count = max(2, round(size / country.ward))
    return count, size / count


def draw_wards(size: int, country: Country, seed: int, blocks: Sequence[Block]) -> Wards:
    """Draw the wards of a map of a size in m.

    Every ward can be reached from every other: the ways through borders form a tree, plus a few loops.
    """
    count, side = grid_of(size, country)
    dice = RandomStream(seed, Stream.COUNTRY)
    numbers = np.arange(count * count).reshape(count, count)
    for block in blocks:
        part = numbers[block.row : block.row + block.side, block.column : block.column + block.side]
        part[:] = part.min()
    corners = _draw_corners(dice, size, count, side, blocks)
    kinds = _draw_kinds(dice, country, numbers)
    levels = _draw_levels(dice, kinds, count, blocks)
    sides = _sides_between(numbers)
    towns = {int(numbers[block.row, block.column]) for block in blocks}
    is_open = _draw_ways(dice, [pair for _, _, pair in sides], country.loops)
    borders = []
    for (start, end, pair), opened in zip(sides, is_open, strict=True):
        barrier = _barrier(kinds, levels, pair, towns)
        border = Border(_point(corners[start]), _point(corners[end]), pair, barrier, None)
        share = dice.uniform(*GATE_RANGE)
        borders.append(border._replace(gate=share * border.length) if opened else border)
    return Wards(corners, numbers, kinds, levels, tuple(borders))


def _point(corner: NDArray[np.float64]) -> tuple[float, float]:
    return float(corner[0]), float(corner[1])


def _draw_corners(
    dice: RandomStream, size: int, count: int, side: float, blocks: Sequence[Block]
) -> NDArray[np.float64]:
    """Move the corners of a grid at random, but not those of towns, nor off the edge of the map."""
    corners = np.empty((count + 1, count + 1, 2))
    still = np.zeros((count + 1, count + 1), np.bool_)
    for block in blocks:
        still[block.row : block.row + block.side + 1, block.column : block.column + block.side + 1] = True
    for row in range(count + 1):
        for column in range(count + 1):
            east, north = (side * dice.uniform(-JITTER, JITTER) for _ in range(2))
            is_still = bool(still[row, column])
            corners[row, column] = (
                column * side - size / 2.0 + (0.0 if is_still or column in (0, count) else east),
                row * side - size / 2.0 + (0.0 if is_still or row in (0, count) else north),
            )
    return corners


def _draw_kinds(dice: RandomStream, country: Country, numbers: NDArray[np.int64]) -> tuple[Barrier, ...]:
    """Draw regions of wards of one kind: each ward is of the kind of the nearest of some random points."""
    weights = (country.walls, country.thickets, country.canyons, country.terraces)
    count = len(numbers)
    points = max(sum(weight > 0 for weight in weights), round(count * count / WARDS_OF_REGION))
    seeds = [(dice.uniform(0.0, count), dice.uniform(0.0, count)) for _ in range(points)]
    given = [0.0] * len(weights)
    kinds = []
    for _ in seeds:
        # The kind that is furthest behind its weight is next, so that all of them occur.
        behind = [
            (have + 1.0) / weight if weight else np.inf for have, weight in zip(given, weights, strict=True)
        ]
        kinds.append(Barrier(behind.index(min(behind))))
        given[kinds[-1]] += 1.0
    found = []
    for number in range(count * count):
        row, column = number // count + 0.5, number % count + 0.5
        away = [(row - z) * (row - z) + (column - x) * (column - x) for x, z in seeds]
        found.append(kinds[away.index(min(away))])
    return tuple(found)


def _draw_levels(
    dice: RandomStream, kinds: tuple[Barrier, ...], count: int, blocks: Sequence[Block]
) -> NDArray[np.float64]:
    """Draw the levels of terraces in m; two that adjoin each other differ. All else is at level 0."""
    near_town = np.zeros((count, count), np.bool_)
    for row, column, side in blocks:
        near_town[max(0, row - 1) : row + side + 1, max(0, column - 1) : column + side + 1] = True
    levels = np.zeros(count * count)
    for row in range(count):
        for column in range(count):
            number = row * count + column
            first = dice.integer(0, LEVELS - 1)
            if kinds[number] is not Barrier.CLIFF or near_town[row, column]:
                continue
            beside = [levels[number - 1] if column else -1.0, levels[number - count] if row else -1.0]
            choices = [LEVEL_HEIGHT * level for level in (*range(first, LEVELS), *range(first))]
            levels[number] = next(level for level in choices if level not in beside)
    return levels


def _sides_between(
    numbers: NDArray[np.int64],
) -> list[tuple[tuple[int, int], tuple[int, int], tuple[int, int]]]:
    """Return the sides between cells of different wards: both corners, and the wards left and right."""
    count, sides = len(numbers), []
    for row in range(count):
        for column in range(count):
            here = int(numbers[row, column])
            if column + 1 < count and numbers[row, column + 1] != here:
                pair = here, int(numbers[row, column + 1])
                sides.append(((row, column + 1), (row + 1, column + 1), pair))
            if row + 1 < count and numbers[row + 1, column] != here:
                pair = int(numbers[row + 1, column]), here
                sides.append(((row + 1, column), (row + 1, column + 1), pair))
    return sides


def _draw_ways(dice: RandomStream, pairs: Sequence[tuple[int, int]], loops: float) -> list[bool]:
    """Return for each border whether it has a way through: a random tree over all wards, and some loops."""
    is_open = [False] * len(pairs)
    beside: dict[int, list[tuple[int, int]]] = {}  # by ward: borders, and the wards behind them
    for border, (left, right) in enumerate(pairs):
        beside.setdefault(left, []).append((border, right))
        beside.setdefault(right, []).append((border, left))
    wards = sorted(beside)
    first = wards[dice.integer(0, len(wards) - 1)]
    reached, active = {first}, [first]
    while active:
        last = len(active) - 1
        index = last if dice.uniform() < WINDING else dice.integer(0, last)
        ahead = [(border, ward) for border, ward in beside[active[index]] if ward not in reached]
        if not ahead:
            active.pop(index)
            continue
        border, ward = ahead[dice.integer(0, len(ahead) - 1)]
        is_open[border] = True
        reached.add(ward)
        active.append(ward)
    return [opened or dice.uniform() < loops for opened in is_open]


def _barrier(
    kinds: tuple[Barrier, ...], levels: NDArray[np.float64], pair: tuple[int, int], towns: set[int]
) -> Barrier:
    """Return what stands on the border between two wards."""
    if not towns.isdisjoint(pair):
        return Barrier.TOWN_WALL
    if levels[pair[0]] != levels[pair[1]]:
        return Barrier.CLIFF
    kind = kinds[min(pair)]
    return Barrier.RIDGE if kind is Barrier.CLIFF else kind
