"""Houses can be walked: in at the front door, through every room of every storey, onto the roof, and back."""

import math
from collections import deque

import pytest
from tests.engine.maps.house.built_house import BuiltHouse
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house import FLOOR_LIFT, STOREY_HEIGHT, HousePlan, doorsteps, draw_plan
from wildscav_engine.maps.house.build import can_be_walked_to
from wildscav_engine.maps.house.plan import Flight, Side

Place = tuple[float, float]  # m, in the axes of a house
Node = tuple[int, int]
STEP = 0.5  # m between the nodes of a way
AROUND = 2.0  # m around a house that ways may use


class House(BuiltHouse):
    """A house, and the nodes on its floors where a body can stand."""

    def __init__(self, plan: HousePlan, yaw: float) -> None:
        super().__init__(plan, yaw)
        self.floors = [self._nodes(level) for level in range(len(plan.storeys) + plan.roof_exit)]

    def place(self, node: Node) -> Place:
        return node[0] * STEP - 14.0, node[1] * STEP - 14.0

    def node(self, place: Place) -> Node:
        return round((place[0] + 14.0) / STEP), round((place[1] + 14.0) / STEP)

    def _nodes(self, level: int) -> set[Node]:
        across, along = (size / 2.0 + AROUND for size in self.plan.size)
        first, last = self.node((-across, -along)), self.node((across, along))
        return {
            (column, row)
            for column in range(first[0], last[0] + 1)
            for row in range(first[1], last[1] + 1)
            if self._stands((column, row), self.height(level))
        }

    def _stands(self, node: Node, floor: float) -> bool:
        """Return whether there is floor below a node (or the ground around the house), and room above it."""
        x, z = self.site.pose.outside(*self.place(node))
        below = raycast(self.world, x, floor + 0.4, z, 0.0, -1.0, 0.0, 0.5).distance
        return bool(0.39 < below < 0.49 and is_clear(self.world, x, floor, z))

    def nodes_in(self, level: int, area: Rectangle) -> list[Node]:
        return [
            node
            for node in sorted(self.floors[level])
            if area.left < self.place(node)[0] < area.right and area.back < self.place(node)[1] < area.front
        ]

    def nearest(self, level: int, place: Place) -> Node:
        return min(self.floors[level], key=lambda node: (math.dist(self.place(node), place), node))

    def reached_from(self, level: int, start: Node) -> dict[Node, Node]:
        """Return the nodes of a floor that can be reached, each with the one before it."""
        floor = self.floors[level]
        came = {start: start}
        queue = deque([start])
        while queue:
            column, row = node = queue.popleft()
            for east, north in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
                following = (column + east, row + north)
                if following in came or following not in floor:
                    continue
                if (column + east, row) in floor and (column, row + north) in floor:
                    came[following] = node
                    queue.append(following)
        return came

    def way(self, level: int, start: Place, end: Place) -> list[Place]:
        """Return the corners of a way over one floor."""
        came = self.reached_from(level, self.nearest(level, start))
        node = self.nearest(level, end)
        assert node in came, f"no way on level {level} from {start} to {end}"
        nodes = [node]
        while came[node] != node:
            node = came[node]
            nodes.append(node)
        nodes.reverse()
        corners = [
            node
            for before, node, after in zip(nodes, nodes[1:], nodes[2:], strict=False)
            if (node[0] - before[0], node[1] - before[1]) != (after[0] - node[0], after[1] - node[1])
        ]
        return [start, *(self.place(node) for node in (nodes[0], *corners, nodes[-1])), end]


def before_and_after(flight: Flight) -> tuple[Place, Place]:
    """Return the places 0.6 m before the first step of a flight and 0.6 m after its last."""
    ahead = {Side.FRONT: (0.0, 0.6), Side.RIGHT: (0.6, 0.0), Side.BACK: (0.0, -0.6), Side.LEFT: (-0.6, 0.0)}
    (foot, head), (east, north) = flight.ends, ahead[flight.climbs]
    return (foot[0] - east, foot[1] - north), (head[0] + east, head[1] + north)


def tour(house: House) -> list[tuple[Place, float]]:
    """Return way points from the front door through every room and onto the roof, each with its height."""
    plan = house.plan
    (across, along), side = plan.doors[0]
    out = 1.5 if side in (Side.FRONT, Side.RIGHT) else -1.5
    here = (across, along + out) if side.is_across else (across + out, along)
    points: list[tuple[Place, float]] = [(here, 0.0)]
    for level in range(len(house.floors)):
        floor = house.height(level)
        for target in targets_on(house, level):
            points += [(place, floor) for place in house.way(level, here, target)[1:]]
            here = target
        if level + 1 < len(house.floors):
            assert plan.stairs
            for flight in plan.stairs.flights:
                foot, head = before_and_after(flight)
                if flight.first == 0:
                    points += [(place, floor) for place in house.way(level, here, foot)[1:]]
                    points.append((head, floor + (1.6 if plan.stairs.landing else STOREY_HEIGHT)))
                else:
                    points += [(foot, floor + 1.6), (head, floor + STOREY_HEIGHT)]
                here = head
    return points


def targets_on(house: House, level: int) -> list[Place]:
    """Return a place in every room of a storey and on every roof at its height."""
    plan = house.plan
    areas = [room.area for room in plan.storeys[level].rooms] if level < len(plan.storeys) else []
    areas += [
        wing.inside
        for number, wing in enumerate(plan.wings)
        if wing.storeys == level and can_be_walked_to(plan, number)
    ]
    places = []
    for area in areas:
        nodes = house.nodes_in(level, area)
        assert nodes, f"nobody can stand in {area} of level {level}"
        places.append(house.place(nodes[len(nodes) // 2]))
    return places


HOUSES = [
    *((seed, (1, 4), False) for seed in range(16)),
    *((seed, (3, 4), False) for seed in range(20, 24)),
    *((seed, (2, 3), True) for seed in range(30, 34)),
]


@pytest.mark.parametrize(("seed", "storeys", "small"), HOUSES)
def test_every_room_and_roof_is_walked_to_and_back(seed: int, storeys: tuple[int, int], small: bool) -> None:
    house = House(draw_plan(seed, seed, storeys, small=small), yaw=37.0 * seed)
    way = tour(house)
    for speed in (3.0, 10.0):
        (x, z), *_ = doorsteps(house.plan, house.site, 1.5)
        walker = Walker(house.world, x, 0.0, z)
        for place, height in (*way[1:], *way[-2::-1]):
            there = house.site.pose.outside(*place)
            stuck = f"stuck at {house.site.pose.inside(*walker.position[0, ::2])} on the way to {place}"
            assert walker.walk_to(*there, speed), stuck
            assert abs(walker.position[0, 1] - height) <= FLOOR_LIFT + 0.02


@pytest.mark.parametrize(("seed", "storeys", "small"), HOUSES)
def test_hardly_any_floor_is_cut_off(seed: int, storeys: tuple[int, int], small: bool) -> None:
    house = House(draw_plan(seed, seed, storeys, small=small), yaw=37.0 * seed)
    way = tour(house)
    for level, nodes in enumerate(house.floors):
        start = next(place for place, height in way if abs(height - house.height(level)) < 0.01)
        lost = nodes - set(house.reached_from(level, house.nearest(level, start)))
        for number, wing in enumerate(house.plan.wings):
            if wing.storeys == level and not can_be_walked_to(house.plan, number):
                lost -= set(house.nodes_in(level, wing.inside))
        assert len(lost) <= 0.03 * len(nodes), sorted(house.place(node) for node in lost)


def test_among_them_are_all_kinds_of_houses() -> None:
    plans = [draw_plan(seed, seed, storeys, small=small) for seed, storeys, small in HOUSES]

    assert {len(plan.storeys) for plan in plans} == {1, 2, 3, 4}
    assert {len(plan.wings) for plan in plans} == {1, 2}
    assert {plan.stairs.landing is None for plan in plans if plan.stairs} == {True, False}
    assert sum(plan.roof_exit for plan in plans) >= 2
    assert sum(len(plan.terraces) for plan in plans) >= 2
