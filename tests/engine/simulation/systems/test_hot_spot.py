"""The hot spot: as many boxes as the spec says, where and when it is announced, and robots that know it."""

from typing import Any

import numpy as np
import pytest
from tests.builders import flat_world, map_from

from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase

MOVING = HotSpot(start=2.0, interval=5.0, places=4, radius=6.0, boxes=7, quantity=(3, 5))
ONLY = SupplyConfig(waves=(), hot_spot=MOVING)


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=100, houses=2), 5)


def match_on(game_map: GameMap, track: str = "battle", **changes: Any) -> Match:
    spec: dict[str, Any] = {"supplies": ONLY, "seed": 3, **changes}
    return Match(MatchSpec(track=track, map=game_map.spec, **spec), game_map)


def test_every_place_gets_its_boxes_where_and_when_they_are_announced(country: GameMap) -> None:
    match = match_on(country)
    waves, supplies = match.start_info(0).waves, match.state.supplies
    assert [wave.time for wave in waves] == [2.0, 7.0, 12.0, 17.0]
    assert {wave.radius for wave in waves} == {6.0}
    assert len({wave.center for wave in waves}) > 1
    assert (supplies.quantity[0] > 0).sum() == 4 * 7
    assert set(supplies.quantity[0][supplies.quantity[0] > 0]) == {3, 4, 5}
    for wave in waves:
        now = (supplies.quantity[0] > 0) & (supplies.appears[0] == wave.time * FRAMES_PER_SECOND)
        away = np.hypot(*(supplies.position[0, now][:, [0, 2]] - wave.center).T)
        assert len(away) == 7
        assert away.max() <= 18.0  # three radii
        assert np.median(away) < 12.0


def test_left_to_its_defaults_it_begins_with_the_match_and_moves_nine_times_a_minute_apart(
    country: GameMap,
) -> None:
    match = match_on(country, supplies=SupplyConfig(waves=(), hot_spot=HotSpot()))
    waves, quantity = match.start_info(0).waves, match.state.supplies.quantity[0]
    assert [(wave.time, wave.radius) for wave in waves] == [(60.0 * place, 8.0) for place in range(10)]
    assert (quantity > 0).sum() == 10 * 12
    assert (quantity[quantity > 0].min(), quantity.max()) == (10, 30)


def test_it_is_announced_among_the_waves_by_time(country: GameMap) -> None:
    waves = (SupplyWave(center=(1, 2)), SupplyWave(center=(3, 4), time=10.0))
    match = match_on(country, supplies=SupplyConfig(waves=waves, hot_spot=MOVING))
    assert [wave.time for wave in match.start_info(0).waves] == [0.0, 2.0, 7.0, 10.0, 12.0, 17.0]


def test_the_waves_have_the_same_boxes_with_and_without_it(country: GameMap) -> None:
    waves = (SupplyWave(center=(0, 0), radius=40.0),)
    plain, more = (
        match_on(country, supplies=SupplyConfig(waves=waves, hot_spot=hot_spot)).state.supplies
        for hot_spot in (None, MOVING)
    )
    boxes = int((plain.quantity[0] > 0).sum())
    assert boxes > 5
    assert np.array_equal(plain.position[0, :boxes], more.position[0, :boxes])
    assert np.array_equal(plain.quantity[0, :boxes], more.quantity[0, :boxes])


@pytest.mark.parametrize("seed", range(8))
def test_each_place_is_still_in_the_safe_zone_when_it_moves_on(country: GameMap, seed: int) -> None:
    zone = ZoneConfig(phases=(ZonePhase(wait=5, shrink=15, share=0.4, damage=1),))
    match = match_on(country, "royale", zone=zone, seed=seed)
    _, end, _, _, _, x, z, radius, _ = match.state.matches.zone[0, 0]
    assert end == 20 * FRAMES_PER_SECOND
    last = match.start_info(0).waves[-1]  # it leaves at 22 s
    assert np.hypot(last.center[0] - x, last.center[1] - z) <= radius - 10.0


def test_a_place_without_open_ground_has_fewer_boxes() -> None:
    bare = map_from(flat_world())
    match = match_on(bare, supplies=SupplyConfig(waves=(), hot_spot=HotSpot(places=1, boxes=200, radius=100)))
    assert int((match.state.supplies.quantity[0] > 0).sum()) == len(bare.outdoor)


def test_gatherers_and_fighters_go_where_it_is_announced_and_walkers_do_not() -> None:
    world = map_from(flat_world(size=200))
    places = np.array([[80.0, 0.0, 80.0]])
    world = map_from(world.world._replace(spawns=places))
    start = (-60.0, 0.0, -60.0)
    for name, goes in (("gatherer", True), ("fighter-hard", True), ("walker", False)):
        supplies = SupplyConfig(waves=(), hot_spot=HotSpot(places=1, boxes=1, radius=1))
        match = match_on(world, seats=(name,), start=start, supplies=supplies, time_limit=30)
        match.play_out()
        x, _, z = match.state.agents.position[0, 0]
        assert (np.hypot(80 - x, 80 - z) < 40) == goes, name


def test_a_match_with_a_hot_spot_goes_on_from_its_bytes(country: GameMap) -> None:
    match, other = (
        match_on(country, seats=("gatherer", "fighter"), supplies=supplies, time_limit=20)
        for supplies in (ONLY, None)
    )
    for _ in range(40):
        match.step()
    other.set_state(match.get_state())
    for each in (match, other):
        each.play_out()
    assert other.digest == match.digest


def test_a_batch_makes_room_for_more_places(country: GameMap) -> None:
    few = MatchSpec(track="gathering", map=country.spec, seats=("gatherer",), supplies=ONLY)
    thirty = SupplyConfig(waves=(), hot_spot=HotSpot(places=30, interval=1))
    many = few.model_copy(update={"supplies": thirty})
    batch, alone = Batch([few, few], [country] * 2), Batch([many], [country])
    batch.restart([1], [many], [country])
    assert batch.state.matches.places.tolist() == [4, 30]
    assert np.array_equal(batch.state.matches.hot_spots[1], alone.state.matches.hot_spots[0])


def test_specs_without_one_are_written_as_before_and_specs_with_one_come_back() -> None:
    assert "hot_spot" not in SupplyConfig().model_dump_json()
    assert SupplyConfig.model_validate_json(ONLY.model_dump_json()) == ONLY
