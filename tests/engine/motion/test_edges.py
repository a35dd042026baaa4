"""The edge of the map: no body gets over it, and none gets stuck at it."""

import math

import numpy as np
import pytest
from tests.builders import act, flat_world, make_match, place, position

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import build_world


def test_nobody_leaves_the_map() -> None:
    match = make_match()
    place(match, 0, (15, 0, 15))
    act(match, 30, seat_0={"walk_direction": 45, "walk_speed": 10})
    assert position(match) == pytest.approx([19.5, 0, 19.5])


def test_a_body_beyond_the_margin_is_not_pulled_back_but_walks_back() -> None:
    match = make_match(frames_per_action=1)
    place(match, 0, (0, 0, 19.9))
    act(match, 1, seat_0={"walk_direction": 0, "walk_speed": 10})
    assert position(match) == pytest.approx([0, 0, 19.9])
    act(match, 1, seat_0={"walk_direction": 135, "walk_speed": 10})
    assert position(match) == pytest.approx([0.2 * math.sqrt(0.5), 0, 19.9 - 0.2 * math.sqrt(0.5)])


@pytest.mark.parametrize(("along", "climbs"), [(0.5, True), (0.95, True), (1.1, False)])
def test_between_steep_ground_and_the_edge_one_walks_along_as_in_a_gully(along: float, climbs: bool) -> None:
    """The ground is 60° steep and falls to the edge in the east; northwards it rises ``along`` m a metre."""
    side = np.arange(21) * 2.0 - 20.0
    outwards = math.sqrt(3.0 - along * along)
    heights = along * side[:, None] - outwards * side[None, :]
    world = build_world((-20.0, -20.0), heights, np.full((20, 20), -np.inf), [], flat_world().spawns)
    match = make_match(world=world)
    for x, expected in ((19.5, climbs), (0.0, False)):
        place(match, 0, (x, ground_at(world, x, 0.0).height, 0.0))
        before = position(match)[1]
        act(match, 6, seat_0={"walk_direction": 0, "walk_speed": 10})
        assert (position(match)[1] > before + 0.5) == expected
