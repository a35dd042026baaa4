"""Agents and boxes that are put into pictures by hand are those of matches."""

import numpy as np
from tests.builders import make_match, place

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of, placed_objects


def test_what_is_placed_looks_as_it_does_in_a_match() -> None:
    match = make_match(seats=2)
    place(match, 0, (1.0, 0.5, 2.0), yaw=30.0)
    place(match, 1, (-4.0, 0.0, 3.0), yaw=-90.0)
    match.state.agents.invincible_left[:] = 0
    match.state.supplies.quantity[:] = 0

    of_match = dynamic_objects_of(match)
    placed = placed_objects([((1.0, 0.5, 2.0), 30.0), ((-4.0, 0.0, 3.0), -90.0)], [])

    for one, other in zip(of_match, placed, strict=True):
        assert np.array_equal(one, other)
    assert np.array_equal(of_match.instance, placed.instance)
    assert np.array_equal(of_match.color, placed.color)


def test_boxes_stand_where_they_are_put() -> None:
    things = placed_objects([], [(1.0, 2.0, 3.0), (5.0, 0.0, -6.0)])
    assert set(things.kind.tolist()) == {Kind.SUPPLY_BOX}
    for number, (x, y, z) in enumerate([(1.0, 2.0, 3.0), (5.0, 0.0, -6.0)]):
        own = things.instance == number
        low, high = things.low[own].min(axis=0), things.high[own].max(axis=0)
        assert np.all(low < (x, y + 0.1, z))
        assert np.all(high > (x, y + 0.1, z))
        assert np.all(high - low < 1.0)


def test_nothing_may_be_placed() -> None:
    assert len(placed_objects([], []).kind) == 0
