"""Motion: what a body can do, and what it never does."""

import math
from typing import Any

import pytest
from tests.builders import act, box, flat_world, make_match, place, position

from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.world import Kind
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, JUMP_SPEED


@pytest.mark.parametrize(
    ("direction", "x", "z"),
    [
        (0, 0, 10),
        (90, 10, 0),
        (180, 0, -10),
        (270, -10, 0),
        (-90, -10, 0),
        (450, 10, 0),
        (45, 7.0711, 7.0711),
    ],
)
def test_walking_5_metres_a_second_for_2_seconds_moves_10_metres(
    direction: float, x: float, z: float
) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 20, seat_0={"walk_direction": direction, "walk_speed": 5})
    assert position(match) == pytest.approx([x, 0, z], abs=1e-3)
    assert match.state.agents.walked[0, 0] == pytest.approx(10, abs=1e-6)


@pytest.mark.parametrize("action", [{"walk_speed": 10.001}, {"walk_speed": -1}, {"walk_speed": math.nan}])
def test_an_impossible_walk_speed_is_no_action(action: dict[str, float]) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 5, seat_0={**action, "turn": 3})
    assert position(match) == pytest.approx([0, 0, 0])
    assert match.state.agents.yaw[0, 0] == 0


@pytest.mark.parametrize("angle", [3e38, -3e38, 1e9])
def test_absurd_but_finite_angles_are_directions_too(angle: float) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": angle, "walk_speed": 5, "turn": angle, "look": angle})
    assert match.state.agents.walked[0, 0] == pytest.approx(5)
    assert -180 < match.state.agents.yaw[0, 0] <= 180
    assert abs(match.state.agents.pitch[0, 0]) == 90


def test_turns_are_degrees_a_frame_and_looks_stop_at_straight_up_and_down() -> None:
    match = make_match()
    act(match, 1, seat_0={"turn": 10, "look": 3})
    assert match.state.agents.yaw[0, 0] == pytest.approx(50)
    assert match.state.agents.pitch[0, 0] == pytest.approx(15)
    act(match, 4, seat_0={"turn": 10, "look": 10})
    assert match.state.agents.yaw[0, 0] == pytest.approx(-110)
    assert match.state.agents.pitch[0, 0] == 90


def doorway(width: float) -> dict[str, object]:
    """Return a wall across the way with a doorway of a width in m."""
    half = width / 2
    sides = [box((5, 0, -10), (5.25, 3, -half)), box((5, 0, half), (5.25, 3, 10))]
    return {"solids": [*sides, box((5, 2.3, -half), (5.25, 3, half))]}


@pytest.mark.parametrize(
    ("world", "steps", "action", "end", "error"),
    [
        ({"water": 0.8}, 10, {"walk_direction": 90, "walk_speed": 8}, (4, 0, 0), 1e-6),  # half as fast
        (
            {"water": 0.8},
            20,
            {"walk_direction": 90, "walk_speed": 10, "jump": 1},
            (10, 0, 0),
            1e-6,
        ),  # no jumps
        (doorway(1.3), 20, {"walk_direction": 90, "walk_speed": 5}, (10, 0, 0), 1e-3),
        (doorway(0.85), 20, {"walk_direction": 90, "walk_speed": 5}, (5 - BODY_RADIUS, 0, 0), 0.01),  # a slit
        (  # walls are slid along
            {"solids": [box((3, 0, -15), (4, 3, 15))]},
            20,
            {"walk_direction": 45, "walk_speed": 5},
            (3 - BODY_RADIUS, 0, 7.07),
            0.01,
        ),
    ],
)
def test_where_a_body_gets(
    world: dict[str, Any], steps: int, action: dict[str, float], end: tuple[float, ...], error: float
) -> None:
    match = make_match(world=flat_world(**world))
    place(match, 0, (0, 0, 0))
    act(match, steps, seat_0=action)
    assert position(match) == pytest.approx(end, abs=error)
    assert match.state.agents.in_water[0, 0] == ("water" in world)


@pytest.mark.parametrize(("top", "passes"), [(0.3, True), (0.4995, True), (0.5, True), (0.51, False)])
def test_steps_up_to_half_a_metre_are_walked_onto(top: float, passes: bool) -> None:
    match = make_match(world=flat_world(solids=[box((3, 0, -5), (8, top, 5), Kind.STAIR)]))
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert (position(match)[0] > 4) == passes
    assert position(match)[1] == pytest.approx(top if passes else 0, abs=3 * SKIN)


def test_steps_of_just_half_a_metre_are_walked_up_and_down_and_never_fallen_off() -> None:
    steps = [box((2 + n, 0, -5), (12, 0.5 * (n + 1), 5), Kind.STAIR) for n in range(4)]
    match = make_match(world=flat_world(solids=steps), frames_per_action=1)
    place(match, 0, (0, 0, 0))
    highest = 0.0
    for direction in (90, 270):
        for _ in range(80):
            act(match, 1, seat_0={"walk_direction": direction, "walk_speed": 5})
            assert match.state.agents.on_ground[0, 0]
            highest = max(highest, position(match)[1])
    assert highest == pytest.approx(2.0, abs=3 * SKIN)
    assert position(match) == pytest.approx([0, 0, 0], abs=0.01)


def test_a_jump_rises_as_high_as_gravity_allows_and_takes_a_second() -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    heights = []
    act(match, 1, seat_0={"jump": 1})
    while not match.state.agents.on_ground[0, 0]:
        heights.append(position(match)[1])
        act(match, 1)
    assert max(heights) == pytest.approx(JUMP_SPEED**2 / (2 * 9.81), abs=0.02)
    assert 0.9 <= (len(heights) + 1) / 10 <= 1.2
    assert position(match)[1] == 0


def test_a_ceiling_stops_a_jump() -> None:
    match = make_match(world=flat_world(solids=[box((-5, 2.2, -5), (5, 2.4, 5), Kind.FLOOR)]))
    place(match, 0, (0, 0, 0))
    for _ in range(10):
        act(match, 1, seat_0={"jump": 1})
        assert position(match)[1] <= 2.2 - BODY_HEIGHT


def test_heads_are_stood_on_until_they_go_away() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 3, 0))
    match.state.agents.on_ground[0, 1] = False
    act(match, 10)
    assert position(match, 1)[1] == pytest.approx(BODY_HEIGHT, abs=3 * SKIN)
    assert match.state.agents.on_ground[0, 1]
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert position(match, 1)[1] == 0


def test_a_fall_accelerates_and_lands() -> None:
    match = make_match()
    place(match, 0, (0, 20, 0))
    match.state.agents.on_ground[0, 0] = False
    act(match, 10)
    assert position(match)[1] == pytest.approx(20 - 9.81 / 2, abs=1e-9)
    act(match, 20)
    assert position(match)[1] == 0
    assert match.state.agents.velocity[0, 0, 1] == 0
