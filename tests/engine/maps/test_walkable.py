"""Houses can be walked: in at the front door, up every flight of stairs, and out again."""

import math
from collections import deque
from collections.abc import Iterator

import numpy as np
import pytest

from wildscav_engine.geometry.world import World
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.generate import plans_and_sites
from wildscav_engine.maps.house_plan import STOREY_HEIGHT, HousePlan, Rectangle
from wildscav_engine.maps.houses import FLOOR_LIFT, doorsteps
from wildscav_engine.maps.locations import is_clear, reachable_ground
from wildscav_engine.maps.sites import Site
from wildscav_engine.spec import MapConfig
from wildscav_engine.systems.motion import Bodies, move

Place = tuple[float, float]  # m, in the axes of a house
GRID = 0.2  # m
TALL = MapConfig(size=80, houses=4, storeys=(2, 4), vegetation=0.3)


class Walker:
    """A body that walks from way point to way point."""

    def __init__(self, world: World, x: float, y: float, z: float) -> None:
        self.world = world
        self.position = np.array([[x, y, z]])
        self.rise, self.on_ground = 0.0, True

    def walk_to(self, x: float, z: float, speed: float) -> bool:
        """Walk straight to a place, and return whether it was reached."""
        left = math.hypot(x - self.position[0, 0], z - self.position[0, 2])
        for _ in range(int(left / speed * 50.0 * 2.0) + 50):
            east, north = x - self.position[0, 0], z - self.position[0, 2]
            left = math.hypot(east, north)
            if left < 0.05 and self.on_ground:
                return True
            direction = math.degrees(math.atan2(east, north)) % 360.0
            bodies = Bodies(self.position, np.array([True]), 0)
            moved = move(
                self.world,
                bodies,
                self.rise,
                self.on_ground,
                direction,
                min(speed, left * 50.0),
                False,  # does not jump
                0.5,
            )
            self.position[0] = moved.x, moved.y, moved.z
            self.rise, self.on_ground = moved.rise, moved.on_ground
        return False


def way_on_floor(
    world: World, plan: HousePlan, site: Site, level: int, start: Place, end: Place
) -> list[Place]:
    """Return a way over one floor that keeps clear of walls, stairs and the hole; [] if there is none."""
    floor = site.ground + FLOOR_LIFT + level * STOREY_HEIGHT
    hole = plan.storeys[level].hole
    columns, rows = int(plan.size[0] / GRID) + 1, int(plan.size[1] / GRID) + 1

    def place_of(node: tuple[int, int]) -> Place:
        return node[0] * GRID - plan.size[0] / 2.0, node[1] * GRID - plan.size[1] / 2.0

    def node_of(place: Place) -> tuple[int, int]:
        return round((place[0] + plan.size[0] / 2.0) / GRID), round((place[1] + plan.size[1] / 2.0) / GRID)

    def is_free(node: tuple[int, int]) -> bool:
        across, along = place_of(node)
        if not (0 <= node[0] < columns and 0 <= node[1] < rows):
            return False
        if hole and hole.left <= across <= hole.right and hole.back <= along <= hole.front:
            return False
        x, z = site.pose.outside(across, along)
        return bool(is_clear(world, x, floor, z))

    first = node_of(start)
    came = {first: first}
    queue = deque([first])
    while queue:
        node = queue.popleft()
        if math.dist(place_of(node), end) < 1.5 * GRID:
            break
        for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            following = (node[0] + step[0], node[1] + step[1])
            if following not in came and is_free(following):
                came[following] = node
                queue.append(following)
    else:
        return []
    way = [end]
    while node != first:
        way.append(place_of(node))
        node = came[node]
    return way[::-1]


def ends_of_flight(outline: Rectangle, climb: int) -> tuple[Place, Place]:
    """Return the places 0.6 m before the first step and 0.6 m after the last."""
    middle = (outline.left + outline.right) / 2.0
    back, front = (middle, outline.back - 0.6), (middle, outline.front + 0.6)
    return (back, front) if climb > 0 else (front, back)


def way_through(game_map: GameMap, plan: HousePlan, site: Site) -> Iterator[tuple[Place, float]]:
    """Yield way points from before the front door to the top storey, each with the height expected there."""
    door = plan.storeys[0].outer[0].openings
    middle = next(opening.middle for opening in door if opening.is_doorway)
    here = (middle, plan.size[1] / 2.0 - 0.9)
    floor = site.ground + FLOOR_LIFT
    yield (middle, plan.size[1] / 2.0 + 0.6), site.ground
    yield here, floor
    for level, storey in enumerate(plan.storeys[:-1]):
        assert storey.flight is not None
        foot, head = ends_of_flight(*storey.flight)
        way = way_on_floor(game_map.world, plan, site, level, here, foot)
        assert way, f"no way to the stairs of storey {level}"
        for place in way:
            yield place, floor
        floor += STOREY_HEIGHT
        yield head, floor
        here = head


def walk_through_house(game_map: GameMap, plan: HousePlan, site: Site, speed: float) -> None:
    (x, z), *_ = doorsteps(plan, site, 1.5)
    walker = Walker(game_map.world, x, site.ground, z)
    way = list(way_through(game_map, plan, site))
    for place, height in (*way, *way[::-1]):
        there = site.pose.outside(*place)
        assert walker.walk_to(*there, speed), f"stuck at {site.pose.inside(*walker.position[0, ::2])}"
        assert walker.position[0, 1] == pytest.approx(height, abs=0.02)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("speed", [3.0, 10.0])
def test_every_house_is_walked_to_its_top_storey_and_back(seed: int, speed: float) -> None:
    game_map = generate_map(TALL, seed)

    for plan, site in zip(*plans_and_sites(TALL, seed), strict=True):
        walk_through_house(game_map, plan, site, speed)


def way_over_ground(world: World, start: Place, end: Place) -> list[Place]:
    """Return the nodes of reachable ground from the one nearest to a place to that nearest to another."""
    reachable = reachable_ground(world)

    def node_of(place: Place) -> tuple[int, int]:
        return round(place[0] - world.corner[0]), round(place[1] - world.corner[1])

    first, last = node_of(start), node_of(end)
    came = {first: first}
    queue = deque([first])
    while last not in came:
        column, row = node = queue.popleft()
        for following in ((column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)):
            if following not in came and reachable[following[1], following[0]]:
                came[following] = node
                queue.append(following)
    way = [last]
    while way[-1] != first:
        way.append(came[way[-1]])
    return [(column + world.corner[0], row + world.corner[1]) for column, row in way[::-1]]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_every_outdoor_place_can_be_walked_to(seed: int) -> None:
    game_map = generate_map(MapConfig(size=60, houses=2, water=0.2, vegetation=1.0), seed)
    places = game_map.outdoor
    walker = Walker(game_map.world, *places[0])
    here = places[0]

    for there in places[7::23]:
        for x, z in way_over_ground(game_map.world, (here[0], here[2]), (there[0], there[2])):
            assert walker.walk_to(x, z, 10.0)
        assert walker.walk_to(there[0], there[2], 10.0)
        here = there
        assert walker.position[0, 1] == pytest.approx(there[1], abs=0.01)


@pytest.mark.parametrize("seed", [0, 1])
def test_every_indoor_place_can_be_walked_to_from_the_stairs_or_the_door(seed: int) -> None:
    game_map = generate_map(TALL, seed)
    entered = 0
    for plan, site in zip(*plans_and_sites(TALL, seed), strict=True):
        landings = [place for place, _ in way_through(game_map, plan, site)]
        for x, y, z in game_map.indoor:
            across, along = site.pose.inside(x, z)
            if abs(across) > plan.size[0] / 2.0 or abs(along) > plan.size[1] / 2.0:
                continue
            level = round((y - site.ground - FLOOR_LIFT) / STOREY_HEIGHT)
            start = landings[1] if level == 0 else ends_of_flight(*plan.storeys[level - 1].flight)[1]
            assert way_on_floor(game_map.world, plan, site, level, start, (across, along))
            entered += 1

    assert entered == len(game_map.indoor)
