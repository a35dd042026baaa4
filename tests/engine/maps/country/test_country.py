"""Country maps: towns that can be entered, targets that are a long way round, and nothing of it elsewhere."""

import functools

import numpy as np
import pytest

from wildscav_engine.maps.cache import load_cached, store
from wildscav_engine.maps.country import plan_country
from wildscav_engine.maps.country.hiding import LONGER
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.maps.ground.terrain import make_terrain
from wildscav_engine.maps.house import is_unseen
from wildscav_engine.maps.locations import houses_cut_off
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.setup.starts import HIDDEN_DISTANCE, LEAST_DETOUR, choose_starts
from wildscav_engine.specs.map_spec import Country, MapConfig
from wildscav_engine.specs.match_spec import MatchSpec

CONFIG = MapConfig(
    size=120, houses=2, storeys=(1, 2), relief=0.4, ruggedness=0.2, water=0.02, country=Country()
)


@functools.cache
def country() -> GameMap:
    return generate_map(CONFIG, 3)


def test_open_country_says_nothing_about_it() -> None:
    assert "country" not in MapConfig().model_dump()
    assert MapConfig.model_validate(CONFIG.model_dump(mode="json")) == CONFIG
    assert len(generate_map(MapConfig(size=40, houses=0), 1).targets) == 0


def test_the_same_seed_gives_the_same_country() -> None:
    assert generate_map(CONFIG, 3).digest == country().digest
    assert generate_map(CONFIG, 4).digest != country().digest


def test_a_town_has_houses_all_of_whose_rooms_can_be_entered_and_most_ground_is_reached() -> None:
    assert len(country().houses) >= 2 + 4
    assert houses_cut_off(country().houses, country().indoor) == []
    assert country().reachable_share > 0.6


def test_targets_are_upstairs_indoors_and_outdoors() -> None:
    targets = country().targets
    indoors = [any((country().indoor == place).all(axis=1)) for place in targets]
    assert 6 <= sum(indoors) <= 10
    assert len(targets) > sum(indoors)


def test_a_target_is_a_long_way_round() -> None:
    game_map = country()
    for seed in range(12):
        starts, target = choose_starts(
            MatchSpec(track="navigation", seed=seed, map=game_map.spec), game_map, has_target=True
        )
        assert target is not None
        path = find_path(game_map.graph, starts[0], target)
        straight = np.sqrt(((target - starts[0])[[0, 2]] ** 2).sum())
        assert path is not None
        assert path.length >= 0.97 * LEAST_DETOUR * straight
        assert straight >= HIDDEN_DISTANCE


def test_detours_are_no_longer_than_the_ways_nor_much_shorter() -> None:
    game_map = country()
    for target in range(0, len(game_map.targets), 5):
        for start in range(0, len(game_map.world.spawns), 150):
            place = game_map.world.spawns[start]
            path = find_path(game_map.graph, place, game_map.targets[target])
            assert path is not None
            straight = max(1.0, np.sqrt(((game_map.targets[target] - place)[[0, 2]] ** 2).sum()))
            detour = float(game_map.detours[target, start])
            assert 0.97 * detour <= path.length / straight <= 1.03 * LONGER * detour + 0.01


def test_the_cache_keeps_targets(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    store(country())
    loaded = load_cached(country().spec)
    assert loaded is not None
    assert (loaded.targets == country().targets).all()
    assert (loaded.detours == country().detours).all()


def test_hidden_targets_can_be_turned_off() -> None:
    config = CONFIG.model_copy(update={"country": Country(hidden_targets=False)})
    assert len(generate_map(config, 3).targets) == 0


def test_towns_hold_only_the_pieces_that_are_wanted_and_other_streets() -> None:
    walls = []
    for pieces in ("seen", "unseen"):
        config = CONFIG.model_copy(update={"pieces": pieces})
        plan = plan_country(config, 3, make_terrain(config, 3))
        assert plan is not None
        assert {is_unseen(house) for house in plan.plans} == {pieces == "unseen"}
        walls.append([tuple(wall.low - plan.towns[0].ground) for wall in plan.towns[0].walls])

    assert walls[0] != walls[1] != []
