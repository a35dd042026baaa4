"""Houses can be walked: in at the front door, through every room of every storey, onto the roof, and back."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.maps.house.built_house import BuiltHouse
from tests.engine.maps.walk.walker import Walker

from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house import doorsteps, draw_plan
from wildscav_engine.maps.house.build import can_be_walked_to
from wildscav_engine.maps.walk import NavGraph, build_graph, find_path

HOUSES = [
    *((seed, (1, 4), False) for seed in range(16)),
    *((seed, (3, 4), False) for seed in range(20, 24)),
    *((seed, (2, 3), True) for seed in range(30, 34)),
]
PLANS = [draw_plan(seed, seed, storeys, small=small) for seed, storeys, small in HOUSES]
GRID = np.arange(-20.0, 20.0, 0.5)  # m, of the nodes of a graph


@pytest.fixture(scope="module", params=range(len(PLANS)))
def house(request: pytest.FixtureRequest) -> BuiltHouse:
    return BuiltHouse(PLANS[request.param], yaw=37.0 * HOUSES[request.param][0])


@pytest.fixture(scope="module")
def on_foot(house: BuiltHouse) -> NavGraph:
    """Where a body can walk from outside, without leaps."""
    graph = build_graph(house.world)
    no_leaps = np.zeros_like(graph.leap_start)
    return replace(graph, leap_start=no_leaps, leap_end=graph.leap_end[:0], leap_jump=graph.leap_jump[:0])


def floors_of(house: BuiltHouse) -> list[tuple[Rectangle, float]]:
    """Return every room and every roof that can be walked to, with its height, from below upwards."""
    plan, height = house.plan, house.height
    roofs = [
        (wing.inside, height(wing.storeys)) for n, wing in enumerate(plan.wings) if can_be_walked_to(plan, n)
    ]
    rooms = [(room.area, height(n)) for n, storey in enumerate(plan.storeys) for room in storey.rooms]
    return sorted(rooms + roofs, key=lambda floor: floor[1])


def places_on(
    house: BuiltHouse, places: NDArray[np.float64], area: Rectangle, height: float
) -> NDArray[np.float64]:
    """Return those of some places (N, 3) m that are on a floor."""
    across, along = house.site.pose.inside(places[:, 0], places[:, 2])
    return places[area.holds(across, along) & (np.abs(places[:, 1] - height) < 0.1)]


def test_every_room_and_roof_is_walked_to_and_back(house: BuiltHouse, on_foot: NavGraph) -> None:
    (x, z), *_ = doorsteps(house.plan, house.site, 1.5)
    way = [np.array([x, 0.0, z])]
    for area, height in floors_of(house):
        nodes = places_on(house, on_foot.positions(), area, height)
        assert len(nodes), f"nobody can stand in {area} at {height} m"
        way.append(nodes[len(nodes) // 2])
    for speed in (3.0, 10.0):
        walker = Walker(house.world, *way[0])
        for start, end in pairwise((*way, *way[-2::-1])):
            path = find_path(on_foot, start, end)
            assert path is not None, f"no way from {start} to {end}"
            assert walker.follow(path, speed), f"stuck at {walker.position[0]} on the way to {end}"


def stands(house: BuiltHouse, x: float, height: float, z: float) -> bool:
    """Return whether there is floor below a place, and room for a body above it."""
    below = raycast(house.world, x, height + 0.4, z, 0.0, -1.0, 0.0, 0.5).distance
    return bool(0.39 < below < 0.49 and is_clear(house.world, x, height, z))


def test_hardly_any_floor_is_cut_off(house: BuiltHouse, on_foot: NavGraph) -> None:
    nodes = on_foot.positions(np.flatnonzero(on_foot.connected)).tolist()
    for height in {height for _, height in floors_of(house)}:
        grid = np.array([(x, height, z) for x in GRID for z in GRID])
        areas = [area for area, level in floors_of(house) if level == height]
        spots = np.concatenate([places_on(house, grid, area, height) for area in areas]).tolist()
        free = {(x, z) for x, _, z in spots if stands(house, x, height, z)}
        lost = free - {(x, z) for x, y, z in nodes if abs(y - height) < 0.1}
        assert len(lost) <= 0.03 * len(free), sorted(lost)


def test_among_them_are_all_kinds_of_houses() -> None:
    assert {len(plan.storeys) for plan in PLANS} == {1, 2, 3, 4}
    assert {len(plan.wings) for plan in PLANS} == {1, 2}
    assert {plan.stairs.landing is None for plan in PLANS if plan.stairs} == {True, False}
    assert sum(plan.roof_exit for plan in PLANS) >= 2
    assert sum(len(plan.terraces) for plan in PLANS) >= 2
