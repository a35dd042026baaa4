"""Ways over surfaces that were seen: around walls, up stairs and down again, and into the unknown."""

import math

import numpy as np
import pytest

from wildscav.skills.paths import find_ways
from wildscav.skills.surroundings import CELL, Rings, Surroundings

HERE = (0.0, 0.0, 0.0)
RINGS = Rings(range=20.0, lowest=-45.0, highest=45.0)


def field(half: float = 8.0) -> Surroundings:
    """Level ground around the origin that has been seen."""
    surroundings = Surroundings(100.0, RINGS)
    for x in np.arange(-half, half, CELL / 2):
        for z in np.arange(-half, half, CELL / 2):
            surroundings.stand((float(x), 0.0, float(z)))
    return surroundings


def wall(surroundings: Surroundings, z: float, west: float, east: float) -> None:
    for x in np.arange(west, east, CELL / 2):
        surroundings.block((float(x), 0.0, z))


def test_a_way_over_open_ground_is_straight() -> None:
    way = find_ways(field(), HERE, {7: (0.0, 0.0, 6.0)}, 10.0).to[7]

    assert way.length == pytest.approx(5.1, abs=0.5)  # up to 1 m before the box
    assert max(abs(x) for x, _, _ in way.points) < 0.5


def test_a_way_leads_around_a_wall_and_keeps_off_it() -> None:
    surroundings = field()
    wall(surroundings, 3.0, -4.0, 2.0)

    way = find_ways(surroundings, HERE, {7: (0.0, 0.0, 6.0)}, 10.0).to[7]

    assert way.length > 6.0
    assert min(math.dist(point, (2.0, 0.0, 3.0)) for point in way.points) > CELL


def test_a_goal_behind_a_closed_wall_has_no_way() -> None:
    surroundings = field()
    wall(surroundings, 3.0, -50.0, 50.0)

    assert find_ways(surroundings, HERE, {7: (0.0, 0.0, 6.0)}, 10.0).to == {}


def stairs() -> Surroundings:
    """A field with stairs to the north: up by 0.2 m every 0.3 m, to a floor at 3 m."""
    surroundings = field(3.0)
    for step in range(40):
        height = min(0.2 * step, 3.0)
        for x in np.arange(-1.0, 1.0, CELL / 2):
            surroundings.stand((float(x), height, 3.0 + 0.3 * step))
    return surroundings


def test_a_way_leads_up_the_stairs_and_back_down() -> None:
    surroundings, upstairs = stairs(), (0.0, 3.0, 12.0)

    up = find_ways(surroundings, HERE, {7: upstairs}, 16.0).to[7]
    down = find_ways(surroundings, upstairs, {8: HERE}, 16.0).to[8]

    assert up.points[-1][1] == pytest.approx(3.0, abs=0.3)
    assert down.points[-1][1] == pytest.approx(0.0, abs=0.5)


def test_a_box_upstairs_is_not_reached_from_below() -> None:
    assert find_ways(field(), HERE, {7: (0.0, 3.0, 2.0)}, 10.0).to == {}


def test_an_unseen_place_is_looked_for_in_the_direction_of_a_hint() -> None:
    way = find_ways(field(4.0), HERE, {}, 10.0, hints=[(9.0, 0.0, 0.0)]).unseen

    assert way is not None
    assert way.points[-1][0] > 3.5


def test_the_way_toward_a_far_place_leaves_the_building_first() -> None:
    surroundings = field()
    wall(surroundings, 2.0, -3.0, 3.0)  # the far place is to the north, the exit to the south
    for x in np.arange(-3.0, 3.0, CELL / 2):
        for z in np.arange(-2.0, 2.0, CELL / 2):
            surroundings.stand((float(x), 3.0, float(z)))  # the storey above

    way = find_ways(surroundings, HERE, {}, 10.0, far=(0.0, 0.0, 50.0)).toward

    assert way is not None
    assert not surroundings.is_roofed(way.points[-1])
    assert way.points[-1][2] > 3.0


def test_the_lidar_shows_a_wall_where_it_stands() -> None:
    surroundings = Surroundings(100.0, RINGS)
    reading = np.full((9, 8), 20.0, np.float32)
    reading[4, 2] = 5.0  # level, 90 degrees right of the view

    points = surroundings.see((1.0, 0.0, 2.0), 90.0, reading)

    np.testing.assert_allclose(points, [[1.0, 1.5, -3.0]], atol=1e-6)  # looks east: its right is south
    assert surroundings.is_solid((1.0, 1.5, -3.0))
    assert not surroundings.is_free((1.0, 0.3, -3.0))
