"""Rulings on the weapon: what a shot costs, hits and stops at."""

from typing import NamedTuple

import numpy as np
import pytest
from tests.builders import act, box, duel, flat_world, make_match, place

from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.specs.rules import Rules

SHOOT: dict[str, float] = {"shoot": 1}


def test_a_hit_takes_20_health_and_is_told_to_both_for_one_step() -> None:
    match = duel()
    act(match, 1, seat_0=SHOOT)
    agents = match.state.agents
    assert agents.health[0].tolist() == [100, 80]
    assert agents.hit_seat[0].tolist() == [1, -1]
    assert agents.hit_by_seat[0].tolist() == [-1, 0]
    assert agents.fired[0].tolist() == [True, False]
    assert agents.shot_end[0, 0] == pytest.approx([0, 1.5, 9.55])
    act(match, 1)
    assert (agents.hit_seat[0, 0], agents.hit_by_seat[0, 1], agents.fired[0, 0]) == (-1, -1, False)


RELOAD: dict[str, float] = {"reload": 1}
BOTH = {**SHOOT, **RELOAD}


class Then(NamedTuple):
    """What an action is held for, and what the agent has afterwards."""

    steps: int
    action: dict[str, float]
    clip: int
    spare: int
    shots: int


@pytest.mark.parametrize(
    ("frames", "spare", "moves"),
    [
        (5, 60, [Then(10, SHOOT, 10, 60, 5)]),  # it fires five times a second
        (5, 60, [Then(1, RELOAD, 15, 60, 0), Then(1, SHOOT, 14, 60, 1)]),  # a full clip is not reloaded
        # An empty clip is silent until a reload is done.
        (5, 60, [Then(40, SHOOT, 0, 60, 15), Then(1, RELOAD, 0, 60, 15), Then(18, SHOOT, 0, 60, 15)]),
        (5, 60, [Then(40, SHOOT, 0, 60, 15), Then(1, RELOAD, 0, 60, 15), Then(21, SHOOT, 14, 45, 16)]),
        (5, 4, [Then(40, SHOOT, 0, 4, 15), Then(21, RELOAD, 4, 0, 15)]),  # no more rounds than there are
        # An action is held: as long as it asks for a reload, one follows whenever the clip is not full.
        (5, 60, [Then(1, SHOOT, 14, 60, 1), Then(20, BOTH, 14, 60, 1), Then(60, BOTH, 14, 57, 4)]),
        # A reload takes two seconds to the frame, and cannot be hurried.
        (1, 60, [Then(1, SHOOT, 14, 60, 1), Then(100, BOTH, 14, 60, 1), Then(1, RELOAD, 15, 59, 1)]),
    ],
)
def test_rounds_in_the_clip_and_spare_and_shots(frames: int, spare: int, moves: list[Then]) -> None:
    match = duel(rules=Rules(shot_damage=0, spare_ammo=spare), frames_per_action=frames)
    agents = match.state.agents
    for move in moves:
        act(match, move.steps, seat_0=move.action)
        assert (agents.clip[0, 0], agents.spare_ammo[0, 0], agents.shots[0, 0]) == (
            move.clip,
            move.spare,
            move.shots,
        )


def at(height: float) -> float:
    """The pitch, degrees, at which a shot meets the other body at a height in m."""
    return float(np.degrees(np.arctan2(1.5 - height, 9.55)))


SILL, LINTEL = box((-5, 0, 5), (5, 1.0, 5.25)), box((-5, 2.2, 5), (5, 3, 5.25))


@pytest.mark.parametrize(
    ("yaw", "pitch", "solids", "hit"),
    [
        (0, 0, [], True),
        (2, 0, [], True),
        (4, 0, [], False),
        (0, -5, [], False),
        # A body is one upright cylinder from the soles to the crown.
        (0, at(0.02), [], True),  # the feet
        (0, at(1.0), [], True),
        (0, at(1.77), [], True),  # the head: it is one shape with the body, and costs no more
        (0, at(1.80), [], False),  # above it
        (0, 0, [box((-5, 0, 5), (5, 3, 5.25))], False),  # a wall
        (0, 0, [SILL, LINTEL], True),  # a window
    ],
)
def test_an_aimed_shot_hits_a_body(yaw: float, pitch: float, solids: list[Solid], hit: bool) -> None:
    match = duel(flat_world(solids=solids))
    place(match, 0, (0, 0, 0), yaw, pitch)
    act(match, 1, seat_0=SHOOT)
    assert match.state.agents.hits[0, 0] == hit
    assert match.state.agents.health[0, 1] == (80 if hit else 100)


@pytest.mark.parametrize("are_mates", [False, True])
def test_a_shot_ends_in_the_first_body_and_hurts_no_teammate(*, are_mates: bool) -> None:
    match = make_match(seats=3, teams=(0, 0, 1) if are_mates else None)
    for seat, z in enumerate((0, 5, 10)):
        place(match, seat, (0, 0, z))
    act(match, 1, seat_0=SHOOT)
    agents = match.state.agents
    assert agents.health[0].tolist() == [100, 100 if are_mates else 80, 100]
    assert (agents.hit_seat[0, 0], agents.hit_by_seat[0, 1]) == ((-1, -1) if are_mates else (1, 0))
    assert agents.hits[0, 0] == (not are_mates)
    assert agents.shot_end[0, 0, 2] == pytest.approx(4.55)


def test_nobody_is_hit_beyond_the_range() -> None:
    match = duel(rules=Rules(bullet_range=9.0))
    act(match, 1, seat_0=SHOOT)
    assert match.state.agents.hits[0, 0] == 0
    assert match.state.agents.shot_end[0, 0, 2] == pytest.approx(9)


def test_rounds_are_conserved() -> None:
    match = duel(rules=Rules(shot_damage=0))
    random = np.random.default_rng(0)
    for _ in range(300):
        act(match, 1, seat_0={"shoot": float(random.integers(2)), "reload": float(random.random() < 0.1)})
        agents = match.state.agents
        assert agents.clip[0, 0] + agents.spare_ammo[0, 0] + agents.shots[0, 0] == 75


def test_shooting_is_no_part_of_gathering() -> None:
    match = make_match("gathering")
    act(match, 5, seat_0=SHOOT)
    assert match.state.agents.shots[0, 0] == 0


@pytest.mark.parametrize("kind", [Kind.WALL, Kind.CROWN, Kind.TRUNK, Kind.ROCK, Kind.FURNITURE, Kind.BUSH])
def test_whatever_stands_in_the_way_is_cover(kind: Kind) -> None:
    match = duel(flat_world(solids=[box((-1, 0, 5), (1, 3, 6), kind)]))
    act(match, 2, seat_0=SHOOT, seat_1=SHOOT)
    assert match.state.agents.health[0].tolist() == [100, 100]
    assert match.state.agents.shot_end[0, 0, 2] == pytest.approx(5)
    assert match.state.agents.shot_end[0, 1, 2] == pytest.approx(6)


def test_ground_is_cover() -> None:
    match = duel()
    place(match, 0, (0, 0, 0), pitch=45)
    act(match, 1, seat_0=SHOOT)
    assert match.state.agents.shot_end[0, 0] == pytest.approx([0, 0, 1.5])


@pytest.mark.parametrize(("interval", "frames"), [(0.2, 10), (0.02, 1), (0.5, 25), (0.005, 1)])
def test_two_shots_are_so_many_frames_apart(interval: float, frames: int) -> None:
    match = make_match(frames_per_action=1, rules=Rules(fire_interval=interval, clip_size=5))
    fired = []
    for frame in range(60):
        act(match, 1, seat_0=SHOOT)
        if match.state.agents.fired[0, 0]:
            fired.append(frame)
    assert fired == [frames * shot for shot in range(len(fired))]
    assert len(fired) == min(5, -(-60 // frames))


def test_the_last_of_several_hits_in_a_step_is_told() -> None:
    match = make_match(seats=3, rules=Rules(fire_interval=0.02, shot_damage=5))
    for seat in range(3):
        place(match, seat, (0, 0, 10 * seat), yaw=180 * (seat > 0))
    act(match, 1, seat_0=SHOOT, seat_2=SHOOT)
    agents = match.state.agents
    assert agents.hits[0].tolist() == [5, 0, 5]
    assert agents.hit_by_seat[0, 1] in (0, 2)
    assert agents.hit_seat[0].tolist() == [1, -1, 1]
    assert agents.health[0].tolist() == [100, 50, 100]
