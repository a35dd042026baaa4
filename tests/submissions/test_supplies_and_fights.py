"""The baselines of supplies and fights play real matches as their pages say."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest

from wildscav_engine.maps.cache import map_of
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.systems.zone import zone_at
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, Equipment, MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_training.opponents import submission

HOUSE = MapSpec(
    config=MapConfig(size=60, houses=1, storeys=(2, 2), relief=0.2, water=0, vegetation=0), seed=4
)
INDOORS = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), outdoor_richness=0.0, indoor_richness=100.0),))


def play(names: str | Sequence[str], spec: MatchSpec) -> Iterator[Batch]:
    """Play submissions in the first seats; yield the match after each step."""
    batch, match = Batch([spec], [map_of(spec.map)]), np.zeros(1, np.int64)
    players = [submission(name) for name in ([names] if isinstance(names, str) else names)]
    for seat, player in enumerate(players):
        player.begin(batch, match, np.array([seat]))
    actions = no_actions(len(spec.seats))[None]
    while not batch.state.matches.over[0]:
        for seat, player in enumerate(players):
            actions[0, seat] = player.act(batch, match, np.array([seat]))[0]
        batch.step(actions)
        yield batch


FLAT = MapSpec(config=MapConfig(size=100, houses=0, relief=0, water=0, vegetation=0), seed=1)


def duel(**changes: Any) -> MatchSpec:
    """A fight with a robot, 15 m apart on open ground."""
    fields = {
        "track": "battle",
        "map": FLAT,
        "seats": (SUBMISSION, "fighter"),
        "starts": ((0.0, 0.0, 0.0), (0.0, 0.0, 15.0)),
        "seed": 1,
        "time_limit": 8.0,
    }
    return MatchSpec(**{**fields, **changes})


def supplies(name: str, spec: MatchSpec) -> int:
    (*_, last) = play(name, spec)
    return int(last.state.agents.supplies[0, 0])


def test_scavenger_gathers_upstairs_and_comes_down_again() -> None:
    spec = MatchSpec(track="gathering", map=HOUSE, seed=1, time_limit=30.0, supplies=INDOORS)

    heights, gained = [], []
    for batch in play("scavenger", spec):
        heights.append(float(batch.state.agents.position[0, 0, 1]))
        gained.append(int(batch.state.agents.supplies[0, 0]))

    ground = min(heights)
    upstairs = [step for step, height in enumerate(heights) if height > ground + 3.0]
    assert gained[upstairs[-1]] > gained[upstairs[0]]
    assert heights[-1] < ground + 2.0
    assert gained[-1] > 2 * supplies("homing", spec)


def test_commando_fears_nobody_where_nobody_shoots() -> None:
    """Five run for the same heap; in a battle it would leave so many alone."""
    heap = SupplyWave(center=(0.0, 25.0), radius=8.0, outdoor_richness=50.0)
    spec = MatchSpec(
        track="gathering",
        map=FLAT,
        seats=(SUBMISSION, *("gatherer",) * 4),
        starts=((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (-4.0, 0.0, 0.0), (0.0, 0.0, -5.0), (4.0, 0.0, -5.0)),
        seed=1,
        time_limit=10.0,
        supplies=SupplyConfig(waves=(heap,), spacing=3.0),
    )

    assert supplies("commando", spec) == supplies("scavenger", spec) > 20


def test_commando_wins_a_duel_with_a_fighter() -> None:
    (*_, last) = play("commando", duel())

    assert last.state.agents.kills[0].tolist() == [1, 0]


def test_commando_leaves_a_fight_without_ammunition() -> None:
    unarmed = Equipment(clip_size=0)
    distances = []
    for batch in play("commando", duel(equipment=(unarmed, None), time_limit=3.0)):
        here, there = batch.state.agents.position[0]
        if batch.state.agents.health[0, 0] > 0:
            distances.append(float(np.linalg.norm(here - there)))

    assert distances[-1] > 15.0


def test_commando_reloads_before_its_clip_is_empty_once_nobody_is_in_sight() -> None:
    spec = duel(equipment=(None, Equipment(health=160)))  # eight hits

    clips = [int(batch.state.agents.clip[0, 0]) for batch in play("commando", spec)]

    assert 0 < min(clips) < 0.6 * 15
    assert clips[-1] == 15


def test_learned_commando_hits_with_most_of_its_shots_from_wherever_it_looks_first() -> None:
    shots = hits = 0
    for seed in range(6):
        places = ((0.0, 0.0, 0.0), (9.0 - 3.0 * seed, 0.0, 15.0))
        spec = duel(seed=seed, starts=places, equipment=(None, Equipment(health=500)))
        (*_, last) = play("learned-commando", spec)
        shots += int(last.state.agents.shots[0, 0])
        hits += int(last.state.agents.hits[0, 0])

    assert hits > 60
    assert hits > 0.7 * shots


@pytest.mark.parametrize("enemy", ["commando", "hunter"])
def test_survivor_is_not_hit_by_those_who_lead_their_target_and_outlives_them(enemy: str) -> None:
    spec = duel(track="royale", seats=(SUBMISSION, SUBMISSION))

    (*_, last) = play(("survivor", enemy), spec)

    assert last.state.agents.health[0].tolist() == [100, 0]


def test_survivor_stands_in_the_middle_of_the_last_circle() -> None:
    closing = ZonePhase(wait=1.0, shrink=9.0, share=0.0, damage=5)
    spec = duel(track="royale", seats=(SUBMISSION,), starts=None, zone=ZoneConfig(phases=(closing,)))

    depths = []
    for batch in play("survivor", spec.model_copy(update={"time_limit": 9.9})):
        matches = batch.state.matches
        zone = zone_at(matches, 0, int(matches.frame[0]))
        x, _, z = batch.state.agents.position[0, 0]
        depths.append(zone.radius - float(np.hypot(x - zone.x, z - zone.z)))

    assert min(depths) >= 0.0
    assert batch.state.agents.health[0, 0] == 100
