"""Scenarios stay as they are, scores are normalized, and the held-out agents behave as their names say."""

import json
from collections.abc import Iterator, Mapping
from hashlib import blake2b
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world, lay_boxes, make_match, place, position, seen_now

from wildscav.baselines import NAMES
from wildscav_engine.envs import SeatController
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.pools import PARITY
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_evaluator.suites.suite import SUITES, suite
from wildscav_server.hosting.manifest import read_manifest
from wildscav_training.company import scenarios
from wildscav_training.company.scenarios import (
    AGENT,
    HELD_OUT,
    RULES,
    SCENARIOS,
    Scenario,
    company_of,
    matches_of,
    normalized,
    play_in,
)
from wildscav_training.trials import half_width

PINS = {
    "rivals": "c5998516c45e97e3",
    "greedy-mate": "fff4506dee0e0125",
    "snipers": "4ba3dc0f07fcf389",
    "hiders": "48b8b2b2d9203156",
    "copies": "e231673a5a5f6a60",
    "crowd": "9a94a67df14410a6",
    "visitor": "8b2f5e81cf9a69bc",
    "residents": "fd47ab63cb43a3e9",
}


class Idler(SeatController):
    """Does nothing, and notes in which seats."""

    name = "idler"

    def begin(self, batch: Batch, matches: NDArray[np.int64], seats: NDArray[np.int64]) -> None:
        self.batch, self.seats = batch, seats.tolist()

    def act(self, batch: Batch, matches: NDArray[np.int64], seats: NDArray[np.int64]) -> NDArray[np.float32]:
        batch.state.agents.supplies[0] = [0, 10, 20, 30, 40][: len(batch.specs[0].seats)]
        return np.zeros((len(seats), FIELDS), np.float32)


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_scenario_stays_as_it_is(name: str) -> None:
    """What changes gets another name, and a held-out agent that changes makes others of its scenarios."""
    scenario = SCENARIOS[name]
    folder = Path(scenarios.__file__).parent
    versions = [
        read_manifest(folder / one / "submission.toml").version for one in HELD_OUT if one in scenario.seats
    ]
    specs = [spec.model_dump(mode="json") for spec in matches_of(scenario, 2)]

    written = json.dumps([scenario.seats, versions, specs], sort_keys=True)

    assert blake2b(written.encode(), digest_size=8).hexdigest() == PINS[name]
    assert {spec["map"]["seed"] % 2 for spec in specs} == {PARITY["test"]}, (
        "no environment trains on these maps"
    )


@pytest.mark.parametrize(
    ("name", "seats"), [("copies", [0, 1, 2, 3]), ("residents", [0, 1, 2]), ("visitor", [0])]
)
def test_the_agent_has_its_seats_and_the_mean_of_their_scores(
    name: str, seats: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scenarios, "TIME_LIMIT", 0.2)
    idler, scenario = Idler(), SCENARIOS[name]

    trial = play_in(scenario, idler, company_of([scenario]), next(matches_of(scenario, 1)))

    assert idler.seats == seats
    assert trial.metrics["score"] == np.mean([10.0 * seat for seat in seats])


def test_held_out_agents_are_in_no_draw() -> None:
    filled = {
        seat
        for name in SUITES
        for track in SUITES[name].tracks
        for spec in suite(track, name, 1)
        for seat in spec.seats
    }

    assert {seat for one in SCENARIOS.values() for seat in one.seats} == {AGENT, *HELD_OUT} | {
        "commando",
        "hunter",
        "scavenger",
        "homing",
    }
    assert not set(HELD_OUT) & {*filled, *ROBOTS, *NAMES}


def test_normalized_scores() -> None:
    random, reference = [0.0, 10.0, 20.0], [100.0, 110.0, 150.0]  # the reference leads by 100, 100 and 130

    assert normalized(random, random, reference) == [0.0, 0.0, 0.0]
    assert normalized(reference, random, reference) == pytest.approx([1.0, 1.0, 1.0])
    # Its leads of 55 are half of 110, the reference's on average; where that leads by 130, they are less.
    half = normalized([55.0, 65.0, 75.0], random, reference)
    assert half == pytest.approx([0.5 + 5 / 110, 0.5 + 5 / 110, 0.5 - 10 / 110])
    assert half_width(half) == pytest.approx(0.1956, abs=1e-4)
    assert normalized(reference, random, [5.0, 0.0, 30.0]) == [], (
        "no better than random, as far as one can tell"
    )


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
