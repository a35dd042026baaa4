"""Steep ground, cliffs and roofs: what can be climbed, and where bodies slide."""

import math

import numpy as np
import pytest
from tests.builders import act, flat_world, make_match, place, position

from wildscav_engine.geometry.world import Kind, Solid, convex_solid
from wildscav_engine.specs.body import JUMP_SPEED

UPHILL = {"walk_direction": 90, "walk_speed": 10}
STEEPER = [math.tan(math.radians(degrees)) for degrees in (47, 50, 60, 75, 85)]


@pytest.mark.parametrize(
    ("slope", "start", "action", "steps", "least", "most"),
    [
        (0.5, 0, {**UPHILL, "walk_speed": 5}, 10, 4.9, 5.1),  # up to 45° as fast as on level ground
        (0.95, 0, {**UPHILL, "walk_speed": 5}, 10, 4.9, 5.1),
        (1.2, 0, {**UPHILL, "walk_speed": 5}, 10, -20, 0.01),
        *((slope, 0, {**UPHILL, "jump": jump}, 100, -20, 0.7) for slope in STEEPER for jump in (0, 1)),
        (1.2, 0, {}, 10, -5.1, -4.9),  # who stands on it slides down
        *((1.2, 10, {**UPHILL, "jump": jump}, 10, 4.8, 5.2) for jump in (0, 1)),  # nor can one hold on
    ],
)
def test_how_far_uphill_a_body_gets(
    slope: float, start: float, action: dict[str, float], steps: int, least: float, most: float
) -> None:
    match = make_match(world=flat_world(slope=slope))
    place(match, 0, (start, slope * start, 0))
    act(match, steps, seat_0=action)
    assert least < position(match)[0] < most


@pytest.mark.parametrize("jump", [0, 1])
def test_a_cliff_is_not_walked_up_from_level_ground(jump: float) -> None:
    world = flat_world()
    world.heights[:, 12:] = 8.0  # 8 m up within one cell, from x = 2 to x = 4
    match = make_match(world=world)
    place(match, 0, (-5, 0, 0))
    act(match, 50, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": jump})
    assert position(match)[0] < 2.7
    assert position(match)[1] < 2.5


def test_at_the_bottom_of_a_gully_one_stands_walks_along_and_jumps() -> None:
    world = flat_world()
    world.heights[:] = 1.5 * np.abs(np.arange(21) * 2.0 - 20.0)  # both sides 56° steep
    match = make_match(world=world)
    place(match, 0, (3, 4.5, 0))
    act(match, 20)
    assert abs(position(match)[0]) < 0.1
    act(match, 10, seat_0={"walk_direction": 0, "walk_speed": 5})
    assert position(match)[2] == pytest.approx(5, abs=0.1)
    act(match, 5, seat_0={"jump": 1})
    assert position(match)[1] > 1.0


def steep_roof(ridge: float, foot: float) -> Solid:
    """Return a roof that rises at 63° from its foot to its ridge, x in m."""
    top = 2.0 * abs(ridge - foot)
    corners = [(x, y, z) for z in (-4, 4) for x, y in ((foot, 0), (ridge, 0), (ridge, top))]
    faces = ((0, 1, 2), (3, 4, 5), (0, 1, 4), (1, 2, 5), (0, 2, 5))
    return convex_solid(Kind.ROOF, np.array(corners, float), faces)


def test_nobody_runs_or_jumps_up_a_steep_roof() -> None:
    match = make_match(world=flat_world(solids=[steep_roof(ridge=6, foot=3)]))
    place(match, 0, (0, 0, 0))
    highest = 0.0
    for _ in range(40):
        act(match, 1, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": 1})
        highest = max(highest, position(match)[1])
    assert highest <= JUMP_SPEED**2 / (2 * 9.81)


def test_who_falls_between_steep_roofs_stands_there_and_can_jump() -> None:
    roofs = [steep_roof(ridge=6, foot=0), steep_roof(ridge=-6, foot=0)]
    match = make_match(world=flat_world(solids=roofs))
    place(match, 0, (1, 8, 0))
    match.state.agents.on_ground[0, 0] = False
    act(match, 40)
    low = position(match)[1]
    act(match, 10)
    assert position(match)[1] == pytest.approx(low, abs=0.01)
    assert match.state.agents.velocity[0, 0, 1] > -0.5  # however long it was held up
    act(match, 5, seat_0={"jump": 1})
    assert position(match)[1] > low + 0.5


def test_a_gentle_roof_is_walked_on_and_a_steep_one_slides() -> None:
    def stand(height: float) -> float:
        ridge = [(-6, 0, 0), (6, 0, 0), (0, height, 0)]
        vertices = np.array([(x, y, z) for z in (-4, 4) for x, y, _ in ridge], float)
        faces = ((0, 1, 2), (3, 4, 5), (0, 1, 4), (1, 2, 5), (0, 2, 5))
        match = make_match(world=flat_world(solids=[convex_solid(Kind.ROOF, vertices, faces)]))
        place(match, 0, (-3, height / 2 + 0.5, 0))
        match.state.agents.on_ground[0, 0] = False
        act(match, 30)
        return float(position(match)[1])

    assert stand(3.0) > 1.4
    assert stand(9.0) == pytest.approx(0, abs=0.01)
