"""Towns: houses close together behind a wall, and narrow streets between them, many of them dead ends."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.shapes import Rectangle, box, pose
from wildscav_engine.geometry.world import CELL, Kind, Solid
from wildscav_engine.maps.country.wards import Block, grid_of
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.house import HousePlan, draw_house
from wildscav_engine.maps.settlements.footprints import Site
from wildscav_engine.specs.map_spec import Country, MapConfig

LEAST_SIDE = 46.0  # m, of a town
STREET = 3.4  # m, least width of a street
PLOT = 13.0  # m, least distance from one house to the next, from middle to middle
SLACK = 1.4  # m by which houses may be smaller than their plots, and stand off the middle
STEEPEST = 9.0  # m, greatest difference of the natural ground of a town
SHORE = 0.3  # m that the natural ground of a town lies above the water
NUMBER = 20_000  # of the first house of the first town; those of each town start 1,000 later
LOOPS = 0.1  # of the streets that could be dead ends: open at both ends
HEIGHT, THICKNESS = 3.0, 0.4  # m, of the walls across streets
INTO_WALL = 0.12  # m that they reach into the walls of houses
DOOR_SPACE, GATE_SPACE = 2.2, 4.0  # m from such a wall to the middle of a door, and of a gate
SHARES = (0.5, 0.3, 0.7, 0.15, 0.85)  # of a street's length, where it may be walled up, tried in turn

Point = tuple[float, float]


class Town(NamedTuple):
    """A town."""

    area: Rectangle  # m: the side of it, x from left to right, z from back to front
    ground: float  # m
    plans: tuple[HousePlan, ...]
    sites: tuple[Site, ...]
    walls: tuple[Solid, ...]  # across streets

    @property
    def site(self) -> Site:
        """All of it, as the site of one house."""
        left, back, right, front = self.area
        where = pose((left + right) / 2.0, (back + front) / 2.0, 0.0)
        return Site(where, 0.0, (right - left, front - back), self.ground)


def choose_blocks(size: int, country: Country, seed: int, terrain: Terrain) -> list[Block]:
    """Choose where towns are: on dry ground that is as level as possible, apart from each other.

    There are fewer than wanted if there is no more such ground.
    """
    count, side = grid_of(size, country)
    cells = int(LEAST_SIDE / side + 0.999)
    dice = RandomStream(seed, Stream.COUNTRY, agent=1)
    found = []
    for row in range(count - cells + 1):
        for column in range(count - cells + 1):
            block = Block(row, column, cells)
            ground = _heights_in(_area(block, size, side), terrain)
            steep = float(ground.max() - ground.min())
            if ground.min() >= terrain.water_level + SHORE and steep <= STEEPEST:
                found.append((steep + dice.uniform(0.0, 4.0), block))
    chosen: list[Block] = []
    for _, block in sorted(found):
        apart = [max(abs(block.row - one.row), abs(block.column - one.column)) > cells for one in chosen]
        if all(apart) and len(chosen) < country.towns:
            chosen.append(block)
    return chosen


def _area(block: Block, size: int, side: float) -> Rectangle:
    west, south = block.column * side - size / 2.0, block.row * side - size / 2.0
    return Rectangle(west, south, west + block.side * side, south + block.side * side)


def _heights_in(area: Rectangle, terrain: Terrain) -> NDArray[np.float64]:
    """Return the heights in m of the ground in an area."""
    columns = [int((x - terrain.corner[0]) / CELL) for x in (area.left, area.right)]
    rows = [int((z - terrain.corner[1]) / CELL) for z in (area.back, area.front)]
    return terrain.heights[rows[0] : rows[1] + 1, columns[0] : columns[1] + 1]


def draw_town(
    config: MapConfig,
    country: Country,
    seed: int,
    number: int,
    block: Block,
    gates: Sequence[Point],
    terrain: Terrain,
) -> Town:
    """Draw a town with gates in its wall, on ground that is not levelled yet.

    Its streets are a maze; among pieces kept for testing, a main street with lanes off it.
    """
    area = _area(block, config.size, grid_of(config.size, country)[1])
    ground = _heights_in(area, terrain)
    level = float(ground.sum() / ground.size)
    dice = RandomStream(seed, Stream.COUNTRY, agent=100 + number)
    count = max(2, int((area.right - area.left - STREET) / PLOT))
    plot = (area.right - area.left - STREET) / count
    plans, sites = [], []
    for index in range(count * count):
        row, column = divmod(index, count)
        yaw, largest = 90.0 * dice.integer(0, 3), plot - STREET
        across, along = (largest - dice.uniform(0.0, SLACK) for _ in range(2))
        east, north = (across, along) if yaw % 180.0 == 0.0 else (along, across)
        x = area.left + STREET / 2.0 + (column + 0.5) * plot
        z = area.back + STREET / 2.0 + (row + 0.5) * plot
        x += dice.uniform(-0.5, 0.5) * (largest - east)
        z += dice.uniform(-0.5, 0.5) * (largest - north)
        plan = draw_house(
            config.pieces, seed, NUMBER + 1000 * number + index, config.storeys, area=(across, along)
        )
        plans.append(plan)
        sites.append(Site(pose(x, z, yaw), yaw, plan.size, level))
    streets = _Streets(dice, area, count, plans, sites, gates)
    is_open = streets.main_street() if config.pieces == "unseen" else streets.maze()
    walls = tuple(
        box(Kind.WALL, pose(0.0, 0.0, 0.0), (left, level - 0.6, back), (right, level + HEIGHT, front))
        for left, back, right, front in streets.walled_up(is_open)
    )
    return Town(area, level, tuple(plans), tuple(sites), walls)


class _Streets:
    """The streets of a town: a square lattice between its houses, which walls make a tree with few loops.

    Street (row, column, True) runs eastwards from a crossing, (row, column, False) northwards.
    """

    def __init__(
        self,
        dice: RandomStream,
        area: Rectangle,
        count: int,
        plans: Sequence[HousePlan],
        sites: Sequence[Site],
        gates: Sequence[Point],
    ) -> None:
        self.dice, self.area, self.count, self.gates = dice, area, count, gates
        self.wings = [
            [_on_map(site, wing.outline) for wing in plan.wings]
            for plan, site in zip(plans, sites, strict=True)
        ]
        self.doors = [
            [site.pose.outside(*door.middle) for door in plan.doors]
            for plan, site in zip(plans, sites, strict=True)
        ]

    def walled_up(self, open_streets: set[tuple[int, int, bool]]) -> list[Rectangle]:
        """Return the walls across those streets that are not open."""
        walls = []
        for row in range(self.count + 1):
            for column in range(self.count + 1):
                for eastward in (False, True):
                    is_street = (column if eastward else row) < self.count
                    if not is_street or (row, column, eastward) in open_streets:
                        continue
                    if self.dice.uniform() >= LOOPS:
                        walls += self._wall_across(row, column, eastward)
        return walls

    def main_street(self) -> set[tuple[int, int, bool]]:
        """Return one street from end to end and all those that cross it."""
        column, every = self.dice.integer(0, self.count), range(self.count)
        lanes = {(row, lane, True) for row in range(self.count + 1) for lane in every}
        return lanes | {(row, column, False) for row in every}

    def maze(self) -> set[tuple[int, int, bool]]:
        """Return the streets of a random tree that reaches every crossing."""
        dice, active = self.dice, [(0, 0)]
        reached, found = {(0, 0)}, set()
        while active:
            row, column = active[-1]
            ahead = [
                (there, street)
                for there, street in (
                    ((row, column + 1), (row, column, True)),
                    ((row, column - 1), (row, column - 1, True)),
                    ((row + 1, column), (row, column, False)),
                    ((row - 1, column), (row - 1, column, False)),
                )
                if there not in reached and min(there) >= 0 and max(there) <= self.count
            ]
            if not ahead:
                active.pop()
                continue
            there, street = ahead[dice.integer(0, len(ahead) - 1)]
            found.add(street)
            reached.add(there)
            active.append(there)
        return found

    def _wall_across(self, row: int, column: int, eastward: bool) -> list[Rectangle]:
        """Return the wall across a street, none if none leaves doors and gates free."""
        houses = [(row - 1, column), (row, column)] if eastward else [(row, column - 1), (row, column)]
        known = [number for number in (self._house(*house) for house in houses) if number is not None]
        first, last = self._shared_span(known, eastward)
        for share in SHARES:
            at = first + share * (last - first)
            low = self._edge(self._house(*houses[0]), at, eastward, ahead=True)
            high = self._edge(self._house(*houses[1]), at, eastward, ahead=False)
            if low is None or high is None or not self._is_free(known, at, low, high, eastward):
                continue
            low, high, half = low - INTO_WALL, high + INTO_WALL, THICKNESS / 2.0
            if eastward:
                return [Rectangle(at - half, low, at + half, high)]
            return [Rectangle(low, at - half, high, at + half)]
        return []

    def _house(self, row: int, column: int) -> int | None:
        is_one = 0 <= row < self.count and 0 <= column < self.count
        return row * self.count + column if is_one else None

    def _shared_span(self, houses: Sequence[int], eastward: bool) -> Point:
        """Return where, along a street, there are houses on all of its sides that can have one."""
        spans = []
        for house in houses:
            wings = self.wings[house]
            if eastward:
                spans.append((min(wing.left for wing in wings), max(wing.right for wing in wings)))
            else:
                spans.append((min(wing.back for wing in wings), max(wing.front for wing in wings)))
        return max(span[0] for span in spans), min(span[1] for span in spans)

    def _edge(self, house: int | None, at: float, eastward: bool, *, ahead: bool) -> float | None:
        """Return where a street begins at the side of a house, or at the town's wall; None in a gap."""
        if house is None:
            least, most = (self.area.back, self.area.front) if eastward else (self.area.left, self.area.right)
            return least if ahead else most
        edges = []
        for left, back, right, front in self.wings[house]:
            start, end, low, high = (left, right, back, front) if eastward else (back, front, left, right)
            if start + 0.5 <= at <= end - 0.5:
                edges.append(high if ahead else low)
        if not edges:
            return None
        return max(edges) if ahead else min(edges)

    def _is_free(self, houses: Sequence[int], at: float, low: float, high: float, eastward: bool) -> bool:
        """Return whether a wall is away from all doors on the street, and from all gates."""
        for points, space in (
            *((self.doors[house], DOOR_SPACE) for house in houses),
            (self.gates, GATE_SPACE),
        ):
            for x, z in points:
                along, aside = (x, z) if eastward else (z, x)
                if abs(along - at) < space and low - 1.0 < aside < high + 1.0:
                    return False
        return True


def _on_map(site: Site, outline: Rectangle) -> Rectangle:
    """Return a rectangle of a house in the axes of the map; the yaw of the house is a multiple of 90°."""
    ends = site.pose.outside(outline.left, outline.back), site.pose.outside(outline.right, outline.front)
    x, z = zip(*ends, strict=True)
    return Rectangle(min(x), min(z), max(x), max(z))
