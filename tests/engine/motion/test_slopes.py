"""Steep ground, cliffs and roofs: what can be climbed, and where bodies slide."""

import math

import numpy as np
import pytest
from tests.builders import act, flat_world, make_match, place, position

from wildscav_engine.geometry.world import Kind, Solid, convex_solid
from wildscav_engine.specs.body import JUMP_SPEED


@pytest.mark.parametrize(("slope", "climbs"), [(0.5, True), (0.95, True), (1.2, False)])
def test_ground_is_climbed_up_to_45_degrees(slope: float, climbs: bool) -> None:
    match = make_match(world=flat_world(slope=slope))
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert (position(match)[0] > 4.9) == climbs
    assert (position(match)[0] < 0.01) != climbs


@pytest.mark.parametrize("degrees", [47, 50, 60, 75, 85])
@pytest.mark.parametrize("action", [{"walk_speed": 10}, {"walk_speed": 10, "jump": 1}])
def test_nobody_climbs_steeper_ground_at_any_speed_jumping_or_not(
    degrees: float, action: dict[str, float]
) -> None:
    match = make_match(world=flat_world(slope=math.tan(math.radians(degrees))))
    place(match, 0, (0, 0, 0))
    act(match, 100, seat_0={"walk_direction": 90, **action})
    assert position(match)[0] < 0.7


@pytest.mark.parametrize("jump", [0, 1])
def test_a_cliff_is_not_walked_up_from_level_ground(jump: float) -> None:
    world = flat_world()
    world.heights[:, 12:] = 8.0  # 8 m up within one cell, from x = 2 to x = 4
    match = make_match(world=world)
    place(match, 0, (-5, 0, 0))
    act(match, 50, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": jump})
    assert position(match)[0] < 2.7
    assert position(match)[1] < 2.5


def test_whoever_stands_on_steeper_ground_slides_down() -> None:
    match = make_match(world=flat_world(slope=1.2))
    place(match, 0, (0, 0, 0))
    act(match, 10)
    assert position(match)[0] == pytest.approx(-5, abs=0.1)


@pytest.mark.parametrize("action", [{"walk_speed": 10}, {"walk_speed": 10, "jump": 1}])
def test_nobody_holds_on_to_ground_that_is_too_steep(action: dict[str, float]) -> None:
    match = make_match(world=flat_world(slope=1.2))
    place(match, 0, (10, 12, 0))
    act(match, 10, seat_0={"walk_direction": 90, **action})  # uphill
    assert position(match)[0] == pytest.approx(5, abs=0.2)


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
