"""What agents see of each other and of supply boxes, as arrays: no more than the rules let them see."""

import math
from typing import Any

import numpy as np
import pytest
from tests.builders import act, box, flat_world, lay_boxes, make_match, place

from wildscav_engine.sensors import NearbySupplies, Sights, Teammates, ToSupplies, VisibleAgents
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.rules import Rules


def with_boxes(*distances: float, **spec: Any) -> Match:
    """An agent at (1, 0, 2) and boxes so far to the north of it, the nth with n + 1 supplies."""
    match = make_match("gathering", world=flat_world(80), **spec)
    place(match, 0, (1, 0, 2), yaw=90)
    quantity = range(1, len(distances) + 1)
    lay_boxes(match, *((1, 0, 2 + distance) for distance in distances), quantity=quantity)
    act(match, 1)
    return match


def test_boxes_come_nearest_first_with_their_quantity_and_place() -> None:
    reading = NearbySupplies(limit=4).read(with_boxes(7.0, 3.0), [0])[0]
    assert reading.tolist() == [
        [1, 2, 0, 0, 3, 3],
        [1, 1, 0, 0, 7, 7],
        [0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 0, 0],
    ]


@pytest.mark.parametrize(
    ("sight", "asked", "listed"),
    [
        (20.0, 20.0, 2),
        (20.0, 200.0, 2),  # who asks for more than the rules allow gets what they allow
        (40.0, 20.0, 2),
        (40.0, 200.0, 3),
        (40.0, 9.9, 1),
        (5.0, 20.0, 1),
        (0.0, 20.0, 0),
    ],
)
def test_no_box_is_listed_beyond_the_range_or_the_rules_sight(
    sight: float, asked: float, listed: int
) -> None:
    match = with_boxes(5.0, 10.0, 25.0, rules=Rules(supply_sight=sight))
    reading = NearbySupplies(range=asked).read(match, [0])[0]
    assert reading[:, 0].sum() == listed
    assert not reading[listed:].any()


def test_the_limit_keeps_the_nearest() -> None:
    match = with_boxes(*np.linspace(18, 2, 6).tolist())
    reading = NearbySupplies(limit=2).read(match, [0])[0]
    assert reading[:, 5] == pytest.approx([2.0, 5.2])


def test_an_agent_in_sight_is_told_of_as_the_observation_tells() -> None:
    match = make_match(seats=3, world=flat_world(80), rules=Rules(start_health=70, shot_damage=20))
    place(match, 0, (1, 0, 2))
    place(match, 1, (1, 0, -9))  # behind
    place(match, 2, (4, 0, 6), yaw=-100)
    act(match, 1, seat_2={"walk_direction": 90, "walk_speed": 2})
    east = float(match.state.agents.position[0, 2, 0]) - 1
    reading = VisibleAgents().read(match, [0])[0]
    way = np.hypot(east, 4)
    team = int(match.state.agents.team[0, 2])
    assert reading.shape == (16, 13)
    assert reading[0] == pytest.approx([1, 2, team, east, 0, 4, way, 2, 0, 0, -100, 70, 0], abs=1e-5)
    assert not reading[1:].any()
    match.state.agents.invincible_left[0, 2] = 5
    assert VisibleAgents().read(match, [0])[0, 0, 12] == 1


def test_agents_behind_a_wall_are_not_listed_and_the_limit_keeps_the_nearest() -> None:
    wall = box((-3, 0, 12), (3, 3, 12.3))
    match = make_match(seats=4, world=flat_world(80, [wall]))
    place(match, 0, (0, 0, 0))
    for seat, z in enumerate((11.0, 4.0, 14.0), start=1):
        place(match, seat, (0, 0, z))
    act(match, 1)
    assert VisibleAgents().read(match, [0])[0, :3, :2].tolist() == [[1, 2], [1, 1], [0, 0]]
    assert VisibleAgents(limit=1).read(match, [0])[0, :, :2].tolist() == [[1, 2]]


def test_the_dead_have_nothing_in_sight() -> None:
    match = make_match(seats=2, rules=Rules(shot_damage=100))
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, 10), yaw=180)
    act(match, 1, seat_0={"shoot": 1})
    assert not VisibleAgents().read(match, [0, 1]).any()


def test_an_enemy_in_sight_is_told_of_by_the_turn_that_aims_at_it_now_and_where_it_goes() -> None:
    match = make_match("battle", seats=3, teams=(0, 0, 1), world=flat_world(80))
    place(match, 0, (0, 0, 0), yaw=10, pitch=-2)
    place(match, 1, (0, 0, 3))  # a teammate
    place(match, 2, (3, 0, 4), yaw=60 + np.degrees(np.arctan2(-3, -4)))  # half turned to the reader
    act(match, 1)
    match.state.agents.velocity[0, [0, 2]] = (0, 0, 2), (-6, 0, 0)  # in half a second it is 3 m ahead
    turns = np.degrees(np.arctan2((3, 0.4, 0, 0.4), (4, 5, 3, 3))) - (10, -2, 10, -2)
    wide = np.degrees(np.arctan2(BODY_RADIUS, 5))
    row, unused = Sights(limit=2, lead=0.5).read(match, [0])[0]
    logarithms = np.sign(turns) * np.log1p(np.abs(turns))
    assert row == pytest.approx([1, *logarithms, np.log1p(wide), 0.5, np.log(6), 100, 0], abs=1e-5)
    assert not unused.any()


def test_teammates_are_listed_nearest_first_in_sight_or_not() -> None:
    match = make_match("battle", seats=5, teams=(0, 0, 1, 0, 1))
    for seat, spot in enumerate(((0, 0, 0), (0, 0, -9), (1, 0, 0), (3, 0, 4), (0, 0, 2))):
        place(match, seat, spot)
    agents = match.state.agents
    agents.velocity[0, 3], agents.yaw[0, 3] = (1, 2, 3), 50
    agents.supplies[0, 3], agents.invincible_left[0, 3], agents.health[0, 1] = 12, 5, 0
    near, far, *unused = Teammates().read(match, [0])[0]
    assert near.tolist() == [1, 3, 3, 0, 4, 5, 1, 2, 3, 50, 100, 1, 12]
    assert far[[1, 4, 10]].tolist() == [1, -9, 0]
    assert not np.any(unused)


def test_only_as_many_as_asked_for_are_listed() -> None:
    match = make_match("gathering", seats=4, teams=(0, 0, 0, 0))
    assert Teammates(limit=2).read(match, [0, 3])[:, :, 0].tolist() == [[1, 1], [1, 1]]


NEAR_POOR, FAR_RICH, ABOVE = (0.0, 0.0, 2.0), (-6.0, 0.0, 0.0), (3.0, 2.0, 0.0)


def ways(match: Match, **options: Any) -> list[list[float]]:
    rows: list[list[float]] = ToSupplies(**options).read(match, [0])[0].tolist()
    return rows


@pytest.fixture
def supplied() -> Match:
    """An agent at the middle that faces east, with a poor box near it and a rich one farther away."""
    match = make_match("gathering")
    place(match, 0, (0.0, 0.0, 0.0), 90)
    lay_boxes(match, NEAR_POOR, FAR_RICH, ABOVE, quantity=(1, 30, 30))
    return match


def test_a_rich_box_is_worth_a_longer_walk(supplied: Match) -> None:
    # Efforts for their worth: 9 / 30^0.6 to the rich one, 14 / 30^0.6 to the one above, 5 to the poor one.
    rich, above, poor = ways(supplied)
    assert rich == pytest.approx((1, 0, -1, 0, math.log(7), math.log(31)), abs=1e-6)
    assert above == pytest.approx((1, 0, 1, 2, math.log(4), math.log(31)), abs=1e-6)
    assert poor == pytest.approx((1, -1, 0, 0, math.log(3), math.log(2)), abs=1e-6)


def test_without_worth_the_least_effort_comes_first(supplied: Match) -> None:
    assert [row[4] for row in ways(supplied, worth=0.0)] == pytest.approx(
        [math.log(3), math.log(7), math.log(4)], abs=1e-6
    )


def test_a_start_up_makes_near_boxes_less_attractive(supplied: Match) -> None:
    poor_first, rich_first = (ways(supplied, worth=0.3, start_up=much, limit=1)[0] for much in (0.0, 100.0))
    assert (poor_first[4], rich_first[4]) == pytest.approx((math.log(3), math.log(7)), abs=1e-6)


def test_unused_rows_are_zero(supplied: Match) -> None:
    assert ways(supplied, limit=5)[3:] == [[0.0] * 6] * 2
