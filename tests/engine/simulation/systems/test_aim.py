"""Rulings on the limits of aiming: turns, spread and recoil."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.aim import direction_of_shot
from wildscav_engine.specs.rules import Rules

SHOOT = {"shoot": 1}
WALL = box((-15, 0, 10), (15, 15, 11))


def shooter(rules: Rules, seed: int = 1) -> Match:
    """An agent that looks north at a wall, ten metres away, with rounds for all day."""
    rules = rules._replace(clip_size=1000, fire_interval=0.1)
    match = make_match(world=flat_world(solids=[WALL]), rules=rules, seed=seed)
    place(match, 0, (0, 0, 0))
    return match


def shots(match: Match, count: int, **action: float) -> NDArray[np.float64]:
    """(count, 2) degrees to the right of the view and above it where shots end, each from a level view."""
    ends = []
    for _ in range(count):
        place(match, 0, (0, 0, 0))
        act(match, 1, seat_0={**SHOOT, **action})
        eye = match.state.agents.position[0, 0] + (0, 1.5, 0)
        ends.append(match.state.agents.shot_end[0, 0] - eye)
    x, y, z = np.array(ends).T
    return np.degrees(np.stack((np.arctan2(x, z), np.arctan2(y, np.hypot(x, z))), axis=1))


def off(ends: NDArray[np.float64]) -> float:
    """The greatest distance of shots from the view, degrees."""
    return float(np.hypot(*ends.T).max())


@pytest.mark.parametrize(
    ("turn", "after"),
    [(2.0, 10.0), (50.0, 36.0), (-50.0, -36.0), (350.0, -36.0), (-185.0, 36.0), (7.2, 36.0)],
)
def test_a_body_turns_no_faster_than_the_rules_allow(turn: float, after: float) -> None:
    match = make_match(rules=Rules(turn_speed=360.0))  # 7.2° a frame
    act(match, 1, seat_0={"turn": turn, "look": -turn})
    agents = match.state.agents
    assert agents.yaw[0, 0] == pytest.approx(after, abs=1e-5)
    look = -36.0 if turn > 7.2 else 36.0 if turn < -7.2 else -after
    assert agents.pitch[0, 0] == pytest.approx(look, abs=1e-5)


def test_by_default_a_body_faces_anywhere_at_once() -> None:
    match = make_match()
    act(match, 1, seat_0={"turn": 179.0, "look": 18.0})
    assert match.state.agents.yaw[0, 0] == pytest.approx(5 * 179.0 - 720.0)
    assert match.state.agents.pitch[0, 0] == 90.0


def test_shots_fall_evenly_on_a_disc_around_the_point_aimed_at() -> None:
    ends = shots(shooter(Rules(spread=3.0)), 400)
    distance = np.hypot(*ends.T)
    assert 2.9 < distance.max() < 3.01
    assert np.mean(distance**2) == pytest.approx(3.0**2 / 2, rel=0.15)
    assert np.abs(ends.mean(axis=0)).max() < 0.3


def test_the_spread_of_a_match_follows_from_its_seed() -> None:
    first, again, other = (shots(shooter(Rules(spread=3.0), seed), 5) for seed in (1, 1, 2))
    assert (first == again).all()
    assert (first != other).any()


@pytest.mark.parametrize(
    ("action", "factor"),
    [
        ({}, 1.0),
        ({"walk_direction": 0, "walk_speed": 10}, 3.0),
        ({"walk_direction": 90, "walk_speed": 5}, 2.0),
        ({"look": 2}, 5.0),  # 100 °/s
        ({"walk_direction": 0, "walk_speed": 10, "look": 2}, 7.0),
    ],
)
def test_walking_and_turning_make_shots_less_sure(action: dict[str, float], factor: float) -> None:
    rules = Rules(spread=0.5, walking_sway=2.0, turning_sway=4.0)
    match = make_match(rules=rules._replace(clip_size=1000, fire_interval=0.02), world=flat_world(200))
    offs = []
    for _ in range(40):
        place(match, 0, (0, 0, 0), pitch=-10)
        act(match, 1, seat_0={**SHOOT, **action})
        agents = match.state.agents
        way = agents.shot_end[0, 0] - agents.position[0, 0] - (0, 1.5, 0)
        pitch = np.degrees(np.arctan2(-way[1], np.hypot(way[0], way[2])))
        offs.append(np.hypot(np.degrees(np.arctan2(way[0], way[2])), pitch - agents.pitch[0, 0]))
    assert 0.8 * 0.5 * factor < max(offs) <= 0.5 * factor * 1.02


@pytest.mark.parametrize(("pitch", "action"), [(90, {"look": 5}), (-90, {"look": -5}), (0, {"turn": 360})])
def test_a_view_that_does_not_move_does_not_sway(pitch: float, action: dict[str, float]) -> None:
    match = shooter(Rules(spread=0.5, turning_sway=4.0))
    place(match, 0, (0, 0, 0), pitch=pitch)
    act(match, 1, seat_0={**SHOOT, **action})
    agents = match.state.agents
    way = agents.shot_end[0, 0] - agents.position[0, 0] - (0, 1.5, 0)
    view = direction_of_shot(agents.yaw[0, 0], agents.pitch[0, 0], 0.0, 0, 0, 0)
    assert way @ view / np.linalg.norm(way) >= np.cos(np.radians(0.51))


def test_each_shot_raises_the_view() -> None:
    match = shooter(Rules(recoil=2.0))
    act(match, 3, seat_0=SHOOT)
    assert match.state.agents.pitch[0, 0] == pytest.approx(-6.0)
    assert 0.0 < abs(match.state.agents.yaw[0, 0]) <= 3.0
    place(match, 0, (0, 0, 0), pitch=-89)
    act(match, 2, seat_0=SHOOT)
    assert match.state.agents.pitch[0, 0] == -90.0


def test_a_shot_goes_where_the_view_was_before_its_own_recoil() -> None:
    assert off(shots(shooter(Rules(recoil=5.0)), 3)) < 1e-6


ANGLES = st.floats(-180, 180)


@given(yaw=ANGLES, pitch=st.floats(-90, 90), spread=st.floats(0.01, 90), frame=st.integers(0, 10**6))
def test_a_shot_is_a_unit_vector_within_its_spread(
    yaw: float, pitch: float, spread: float, frame: int
) -> None:
    shot = np.array(direction_of_shot(yaw, pitch, spread, 1, frame, 0))
    view = np.array(direction_of_shot(yaw, pitch, 0.0, 1, frame, 0))
    assert np.linalg.norm(shot) == pytest.approx(1.0)
    assert np.degrees(np.arccos(min(1.0, shot @ view))) <= spread + 1e-5
