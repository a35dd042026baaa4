"""What each field of a GMCommand asks for, where starts and targets are, and what is refused."""

from typing import Any

import numpy as np
import pytest
from tests.platform.legacy.helpers.commands import MAP, command, open_way, setup, vector

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import load_map, map_spec
from wildscav_engine.specs.match_spec import Equipment
from wildscav_engine.specs.rules import Rules
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave
from wildscav_legacy.commander_pb2 import AgentSetup, GameMode, GMCommand, SupplyRefreshData
from wildscav_legacy.episode import Episode, RefusedEpisodeError, read_episode
from wildscav_legacy.session import with_usable_places

BATTLE = GameMode.SUP_BATTLE_MODE


def test_a_command_without_any_field_has_the_originals_defaults() -> None:
    episode = read_episode(GMCommand(num_agents=1, game_mode=BATTLE))
    assert episode.spec.rules == Rules()
    assert episode.spec.equipment_of(0) == (100, 15, 60, 20)
    assert (episode.spec.time_limit, episode.spec.frames_per_action) == (60, 5)
    assert episode.spec.map == map_spec(1)
    assert episode.spec.starts == (None,), "drawn from the seed"
    assert episode.spec.respawn_at == "start"
    assert episode.ids == (0,)
    assert (episode.is_recorded, episode.has_events) == (False, False)


@pytest.mark.parametrize(
    ("fields", "path", "value"),
    [
        ({"timeout": 300}, "time_limit", 300),
        ({"map_id": 101}, "map", map_spec(101)),
        ({"random_seed": 9}, "seed", 9),
        ({"random_seed": -1}, "seed", 2**32 - 1),
        ({"trigger_range": 2.5}, "rules.target_distance", 2.5),
        ({"respawn_time": 3}, "rules.respawn_time", 3),
        ({"respawn_time": 0}, "rules.respawn_time", 0.02),
        ({"invincible_time": 0}, "rules.invincible_time", 0),
        ({"supply_loss_percent_when_dead": 30}, "rules.supply_loss", 0.3),
        ({"water_speed_decay": 0.25}, "rules.water_speed_factor", 0.25),
        ({"supply_grid_length": 7}, "supplies.spacing", 7),
        ({"supply_random_min": 2, "supply_random_max": 6}, "supplies.outdoor_quantity", (2, 6)),
        ({"supply_house_random_min": 3, "supply_house_random_max": 9}, "supplies.indoor_quantity", (3, 9)),
        ({"supply_heatmap_radius": 70}, "supplies.waves.0.radius", 70),
        ({"supply_create_percent": 30}, "supplies.waves.0.outdoor_richness", 30),
        ({"supply_house_create_percent": 90}, "supplies.waves.0.indoor_richness", 90),
        ({"is_random_respawn_location": True}, "respawn_at", "random"),
        ({"is_random_respawn_location": False}, "respawn_at", "start"),
        ({"time_scale": 100}, "frames_per_action", 5),
    ],
)
def test_a_field_becomes_what_the_engine_calls_it(fields: dict[str, Any], path: str, value: object) -> None:
    found: Any = read_episode(command(BATTLE, **fields)).spec
    for part in path.split("."):
        found = found[int(part)] if part.isdigit() else getattr(found, part)
    assert found == pytest.approx(value) if isinstance(value, float) else found == value


def test_the_heat_map_and_its_refreshes_become_waves() -> None:
    asked = command(
        BATTLE, supply_heatmap_radius=100, supply_create_percent=20, supply_house_create_percent=70
    )
    asked.supply_heatmap_center.CopyFrom(vector((-20, 0, 20)))
    asked.supply_refresh_datas.append(
        SupplyRefreshData(
            supply_heatmap_center=vector((33, 0, -44)),
            supply_heatmap_radius=30,
            supply_refresh_time=600,
            supply_create_percent=10,
            supply_house_create_percent=80,
        )
    )
    supplies = read_episode(asked).spec.supplies
    assert isinstance(supplies, SupplyConfig)
    assert supplies.waves == (
        SupplyWave(time=0, center=(-20, 20), radius=100, outdoor_richness=20, indoor_richness=70),
        SupplyWave(time=600, center=(33, -44), radius=30, outdoor_richness=10, indoor_richness=80),
    )


def test_agents_have_their_own_set_ups_and_names() -> None:
    agents = [
        setup(0, (1, 2, 3), hp=50, num_pack_ammo=5, gun_capacity=3, attack_power=7),
        AgentSetup(id=4, agent_name="fox"),
    ]
    episode = read_episode(
        command(BATTLE, agents=agents, is_record=True, replay_suffix="_x", is_Open_Event=True)
    )
    first = Equipment(health=50, spare_ammo=5, clip_size=3, shot_damage=7)
    second = Equipment(health=100, spare_ammo=60, clip_size=15, shot_damage=20)
    assert episode.spec.equipment == (first, second)
    assert episode.spec.starts == ((1, 2, 3), None)
    assert (episode.ids, episode.names) == ((0, 4), ("agent_0", "fox"))
    assert (episode.is_recorded, episode.suffix, episode.has_events) == (True, "_x", True)


def test_agents_that_are_counted_but_not_described_have_the_free_ids() -> None:
    episode = read_episode(command(BATTLE, agents=[setup(1)], num_agents=3))
    assert episode.ids == (1, 0, 2)
    assert episode.spec.seats == ("submission",) * 3


def test_supplies_and_targets_are_for_the_modes_that_have_them() -> None:
    assert read_episode(command(GameMode.NAVIGATION_MODE)).spec.supplies is None
    assert read_episode(command(GameMode.SUP_GATHER_MODE)).spec.target is None
    assert read_episode(command(GameMode.NAVIGATION_MODE)).spec.target == (1, 0, 1)


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"map_id": 1000}, "map_id is 1000, must be 1 to 999"),
        ({"mode": 7}, "game_mode is 7, must be 0 to 2"),
        ({"num_agents": 0}, "num_agents is 0, must be 1 to 1000"),
        ({"agents": [setup(0), setup(1)], "num_agents": 1}, "num_agents is 1, must be 2 to 1000"),
        ({"agents": [setup(2), setup(2)]}, "agent_setups has the ids [2, 2]: they must differ"),
    ],
)
def test_what_cannot_be_is_refused_by_the_name_of_its_field(fields: dict[str, Any], why: str) -> None:
    mode = fields.pop("mode", BATTLE)
    with pytest.raises(RefusedEpisodeError) as refused:
        read_episode(command(mode, **fields))
    assert why in str(refused.value)


@pytest.mark.parametrize(
    ("fields", "path", "played", "said"),
    [
        ({"timeout": 0}, "time_limit", 1, "timeout is 0, must be 1 to 86400: 1 is used"),
        ({"trigger_range": 0}, "rules.target_distance", 0.01, "trigger_range is 0.0, must be 0.01 to 20.0"),
        ({"trigger_range": 50}, "rules.target_distance", 20.0, "trigger_range is 50.0"),
        ({"trigger_range": float("nan")}, "rules.target_distance", 1.0, "trigger_range is nan"),
        ({"trigger_range": float("inf")}, "rules.target_distance", 20.0, "trigger_range is inf"),
        ({"water_speed_decay": 0}, "rules.water_speed_factor", 0.01, "water_speed_decay is 0.0"),
        ({"water_speed_decay": 2}, "rules.water_speed_factor", 1.0, "water_speed_decay is 2.0"),
        ({"respawn_time": -1}, "rules.respawn_time", 0.02, "respawn_time is -1, must be 0 to 600"),
        ({"supply_loss_percent_when_dead": 101}, "rules.supply_loss", 1.0, "supply_loss_percent_when_dead"),
        ({"supply_heatmap_radius": 1001}, "supplies.waves.0.radius", 1000, "supply_heatmap_radius is 1001"),
        ({"supply_create_percent": 51}, "supplies.waves.0.outdoor_richness", 50, "must be 0 to 50: 50 is"),
        ({"supply_grid_length": 101}, "supplies.spacing", 100, "supply_grid_length is 101"),
        ({"supply_grid_length": 0}, "supplies.spacing", 1, "supply_grid_length is 0"),
        ({"supply_random_max": 1001}, "supplies.outdoor_quantity", (1, 1000), "supply_random_max is 1001"),
        (
            {"supply_random_min": 5, "supply_random_max": 1},
            "supplies.outdoor_quantity",
            (1, 5),
            "supply_random_min is 5 and supply_random_max is 1: they are swapped",
        ),
        ({"agents": [setup(3, hp=0)]}, "equipment.0.health", 1, "hp of agent 3 is 0, must be 1 to 10000"),
        (
            {"agents": [setup(3, num_pack_ammo=1_000_000)]},
            "equipment.0.spare_ammo",
            100_000,
            "num_pack_ammo of agent 3 is 1000000",
        ),
        ({"agents": [setup(gun_capacity=1001)]}, "equipment.0.clip_size", 1000, "gun_capacity of agent 0"),
        (
            {"agents": [setup(attack_power=10_001)]},
            "equipment.0.shot_damage",
            10_000,
            "attack_power of agent 0",
        ),
        ({"agents": [setup(3, (0, float("nan"), 0))]}, "starts.0", (0, 0, 0), "start_location of agent 3"),
    ],
)
def test_a_number_out_of_range_counts_as_the_nearest_and_is_told(
    caplog: pytest.LogCaptureFixture, fields: dict[str, Any], path: str, played: object, said: str
) -> None:
    found: Any = read_episode(command(BATTLE, **fields)).spec
    for part in path.split("."):
        found = found[int(part)] if part.isdigit() else getattr(found, part)
    assert found == played
    assert said in caplog.text


def test_a_target_at_infinity_is_as_far_as_maps_are(caplog: pytest.LogCaptureFixture) -> None:
    asked = command(GameMode.NAVIGATION_MODE, target=(float("inf"), 0, float("-inf")))
    assert read_episode(asked).spec.target == (1000, 0, -1000)
    assert "target_location is (inf, 0.0, -inf), must be finite" in caplog.text


def test_a_refresh_too_late_is_told_by_its_name(caplog: pytest.LogCaptureFixture) -> None:
    asked = command(BATTLE)
    asked.supply_refresh_datas.append(SupplyRefreshData(supply_refresh_time=86_401))
    supplies = read_episode(asked).spec.supplies
    assert supplies is not None
    assert supplies.waves[1].time == 86_400
    assert "supply_refresh_time is 86401, must be 0 to 86400: 86400 is used" in caplog.text


def episode(start: Any, target: Any = None) -> Episode:
    return read_episode(command(agents=[setup(0, start)], target=open_way(12) if target is None else target))


@pytest.mark.parametrize("kind", ["indoor", "outdoor"])
def test_valid_locations_stay_as_they_are(kind: str) -> None:
    game_map = load_map(MAP)
    for place in getattr(game_map, kind)[::20].round(3).tolist():
        spec, moved = with_usable_places(episode(place), game_map)
        assert not moved
        assert spec.start_of_seats[0] == pytest.approx(place, abs=1e-5)


def test_what_is_in_a_wall_or_outside_the_map_gives_way_to_the_nearest_location() -> None:
    game_map = load_map(MAP)
    world = game_map.world
    wall = np.flatnonzero(world.solid_kind == Kind.WALL)[0]
    in_wall = ((world.solid_low[wall] + world.solid_high[wall]) / 2).round(3)
    everywhere = np.concatenate([game_map.indoor, game_map.outdoor])
    for place in (np.array([1000.0, 0.0, 0.0]), in_wall):
        spec, moved = with_usable_places(episode(place, target=place), game_map)
        nearest = np.linalg.norm(everywhere - place, axis=1).min()
        for settled in (spec.start_of_seats[0], spec.target):
            assert np.linalg.norm(np.subtract(settled, place)) <= nearest + 3
        assert [line.partition(" (")[0] for line in moved] == ["start_location of agent 0", "target_location"]


def test_places_that_are_not_given_are_drawn() -> None:
    asked = episode(open_way(12))
    asked = asked._replace(spec=asked.spec.model_copy(update={"starts": (None,), "target": None}))
    assert with_usable_places(asked, load_map(MAP)) == (asked.spec, [])
