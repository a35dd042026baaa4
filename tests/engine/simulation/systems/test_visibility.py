"""Rulings on who sees whom, and which boxes."""

import numpy as np
import pytest
from tests.builders import act, box, duel, flat_world, make_match, place

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps import generate_map
from wildscav_engine.simulation.systems.visibility import (
    ASPECT,
    AXIS_POINTS,
    SIDE,
    SIDE_HEIGHT,
    Eye,
    sees_body,
)
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.rules import Rules

HILLS = generate_map(MapConfig(size=100, houses=2, relief=2.0, ruggedness=1.0), 3).world


def watch(
    position: tuple[float, float, float], pitch: float = 0.0, solids: list[Solid] | None = None
) -> bool:
    """Whether an agent at the origin that looks north sees one at a position."""
    match = make_match(seats=2, world=flat_world(80, solids or []))
    place(match, 0, (0, 0, 0), pitch=pitch)
    place(match, 1, position)
    act(match, 1)
    return bool(match.seen.agent_count[0, 0] == 1)


@pytest.mark.parametrize(
    ("position", "pitch", "seen"),
    [
        ((0, 0, 10), 0, True),
        ((0, 0, -10), 0, False),  # behind
        ((9.5, 0, 10), 0, True),  # 43.5° to the right: the view is 90° wide
        ((11, 0, 10), 0, False),
        ((10.4, 0, 10), 0, True),  # its axis is at 46.1°, but its left side in view
        ((-10.4, 0, 10), 0, True),
        ((-9.5, 0, 10), 0, True),
        ((0, 0, 38), 0, True),
        ((0, 9, 10), 0, False),  # 37° up: the view is 50.6° high
        ((0, 0, 10), -60, False),  # who looks at the sky
        ((0, 5, 0), -90, True),  # right above
        ((0, 5, 0), 0, False),
    ],
)
def test_the_view_is_a_frustum(position: tuple[float, float, float], pitch: float, seen: bool) -> None:
    assert watch(position, pitch) == seen


def in_sight(eye: Eye, x: float, y: float, z: float) -> bool:
    """Whether a point is in the vertical view with a clear line of sight."""
    pitch = arctangent(eye.y - y, np.hypot(x - eye.x, z - eye.z))
    is_level = abs(pitch - eye.pitch) <= eye.view_angle * ASPECT * 0.5
    return bool(is_level and sight_is_clear(HILLS, eye.x, eye.y, eye.z, x, y, z))


def test_on_hills_a_body_is_seen_where_any_of_its_points_is() -> None:
    random, found = np.random.default_rng(0), []
    for _ in range(3000):
        (x, z), (to_x, to_z) = random.uniform(-45, 45, (2, 2))
        y, to_y = (float(ground_at(HILLS, *place).height) for place in ((x, z), (to_x, to_z)))
        dx, dz = to_x - x, to_z - z
        # Looks straight at the body, so that all of its points are between left and right.
        eye = Eye(x, y + EYE_HEIGHT, z, arctangent(dx, dz), random.uniform(-20, 20), 90.0)
        level = np.hypot(dx, dz)
        points = [(to_x, to_y + height, to_z) for height in AXIS_POINTS]
        sides = (-SIDE / level, SIDE / level)
        points += [(to_x + side * dz, to_y + SIDE_HEIGHT, to_z - side * dx) for side in sides]
        found.append(sees_body(HILLS, eye, to_x, to_y, to_z))
        assert found[-1] == any(in_sight(eye, *point) for point in points)
    assert 300 < sum(found) < 2700


def window(sill: float) -> list[Solid]:
    """A wall as high as a house, with an opening from a sill in m to a lintel."""
    below, above = box((-9, 0, 5), (9, sill, 5.3)), box((-9, sill + 0.8, 5), (9, 9, 5.3))
    return [below, above, box((-9, 0, 5), (-0.5, 9, 5.3)), box((0.5, 0, 5), (9, 9, 5.3))]


@pytest.mark.parametrize(
    ("solids", "seen"),
    [
        ([box((-3, 0, 5), (3, 3, 5.3))], False),
        ([box((-3, 0, 5), (3, 1.2, 5.3))], True),  # a low wall
        ([box((-3, 0, 9), (0.2, 3, 9.1))], True),  # hides the axis, but not the right side
        ([box((-0.2, 0, 9), (3, 3, 9.1))], True),
        ([box((-0.2, 0, 9), (0.2, 3, 9.1))], True),  # a post in front of it
        ([box((-0.5, 0, 9), (0.5, 3, 9.1))], False),  # as wide as the body
        ([box((-3, 0, 9), (0.5, 3, 9.1))], False),
        (window(0.9), True),
        (window(2.0), False),
        *(([box((-2, 0, 5), (2, 4, 7), kind)], False) for kind in (Kind.CROWN, Kind.BUSH, Kind.TRUNK)),
    ],
)
def test_a_body_is_seen_where_something_does_not_hide_all_of_it(solids: list[Solid], seen: bool) -> None:
    assert watch((0, 0, 10), solids=solids) == seen


def test_seeing_is_not_mutual() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0), yaw=0)
    place(match, 1, (0, 0, 10), yaw=0)
    act(match, 1)
    assert match.seen.agent_count[0].tolist() == [1, 0]


def test_the_nearest_come_first_and_sixteen_at_most() -> None:
    match = make_match(seats=20)
    place(match, 0, (0, 0, -18))
    for seat in range(1, 20):
        place(match, seat, (((seat * 7) % 5) - 2, 0, -14 + seat * 1.5))
    act(match, 1)
    seen = match.seen.agents[0, 0]
    assert match.seen.agent_count[0, 0] == 16
    way = match.state.agents.position[0, seen] - match.state.agents.position[0, 0]
    distances = np.linalg.norm(way, axis=1)
    assert (np.diff(distances) >= 0).all()


def test_the_dead_see_nothing_and_are_not_seen() -> None:
    match = duel(rules=Rules(shot_damage=100))
    act(match, 1, seat_0={"shoot": 1})
    assert match.seen.agent_count[0].tolist() == [0, 0]
