"""The held-out agents behave as their names say."""

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from tests.builders import box, flat_world, lay_boxes, make_match, place, position, seen_now

from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_training.company.scenarios import RULES, Scenario, company_of

Places = Mapping[int, tuple[float, float, float]]  # by seat


def meeting(
    name: str, world: World, start: Places, own: dict[str, float], track: str = "battle", **spec: object
) -> Iterator[Match]:
    """A match of a held-out agent in seat 1 and one in seat 0 that always acts the same, step by step."""
    match = make_match(track, world, seats=2, rules=RULES, **spec)
    lay_boxes(match, *((float(x), 0.0, 0.0) for x in range(-28, 20, 4)))
    for seat, there in start.items():
        place(match, seat, there)
    match.state.agents.invincible_left[:] = 0
    agent, zero, seat = (
        company_of([Scenario(track, (name,))])[name],
        np.zeros(1, np.int64),
        np.ones(1, np.int64),
    )
    agent.begin(match._batch, zero, seat)
    rows: NDArray[np.float32] = np.zeros((2, FIELDS), np.float32)
    for field, value in own.items():
        rows[0, Field[field.upper()]] = value
    while not match.over:
        rows[1] = agent.act(match._batch, zero, seat)[0]
        match.step(rows)
        yield match


def distance(match: Match) -> float:
    return float(np.hypot(*(position(match, 0) - position(match, 1))[[0, 2]]))


def test_the_sniper_hits_from_afar_and_shoots_slowly() -> None:
    shots, clip = [], 15
    for match in meeting("sniper", flat_world(100), {0: (0, 0, 40), 1: (0, 0, 0)}, {}, time_limit=12.0):
        left = int(match.state.agents.clip[0, 1])
        if left < clip:
            shots.append((match.frame, distance(match)))
        clip = left

    assert match.state.agents.kills[0, 1] >= 1
    assert all(later - earlier >= 40 for (earlier, _), (later, _) in pairwise(shots)), "0.8 s at least"
    assert min(far for _, far in shots) > 20.0


def test_the_sniper_keeps_its_distance() -> None:
    walks = {"walk_direction": 90.0, "walk_speed": 4.0}
    near = []
    for match in meeting("sniper", flat_world(100), {0: (-30, 0, 0), 1: (0, 0, 0)}, walks, time_limit=12.0):
        match.state.agents.health[0] = 100
        near.append(distance(match))

    assert position(match, 0)[0] > 15.0, "it walks over the place where the sniper stood"
    assert min(near) > 15.0


def test_the_greedy_mate_gathers_before_its_teammate() -> None:
    walks = {"walk_direction": 90.0, "walk_speed": 5.0, "pick_up": 1.0}
    start = {0: (-30.0, 0.0, 0.0), 1: (-34.0, 0.0, 8.0)}
    *_, match = meeting("greedy", flat_world(100), start, walks, "gathering", teams=(0, 0), time_limit=12.0)

    mate, greedy = match.state.agents.supplies[0].tolist()
    assert greedy > 1.5 * mate
    assert distance(match) < 40.0


def test_the_hider_is_not_seen_where_there_is_something_to_hide_behind() -> None:
    wall, seen = box((-8, 0, 4), (8, 4, 5)), []
    start = {0: (0.0, 0.0, -15.0), 1: (0.0, 0.0, -2.0)}
    for match in meeting("hider", flat_world(60, [wall]), start, {}, time_limit=20.0):
        east, _, north = position(match, 1) - position(match, 0)
        match.state.agents.yaw[0, 0] = np.degrees(np.arctan2(east, north))
        there = seen_now(match)
        seen.append(1 in there.agents[0, 0, : there.agent_count[0, 0]])

    assert seen[0]
    assert not any(seen[len(seen) // 2 :])
    assert match.state.agents.supplies[0, 1] == 0
    assert match.state.agents.clip[0, 1] == 15
