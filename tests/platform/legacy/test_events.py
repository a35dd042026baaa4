"""Boxes, and events, which a client gets if it asks for them."""

from collections.abc import Iterator
from typing import Any

from tests.platform.legacy.helpers.commands import SHOOT, command, duel, setup, vector
from tests.platform.legacy.helpers.competitor import Competitor, begin_at_a_box

from wildscav_legacy.commander_pb2 import EventAgent, GameMode, SupplyRefreshData


def events_of(competitor: Competitor, kind: str) -> Iterator[EventAgent]:
    """Yield what happened to agents in the last step, of one kind."""
    for event in competitor.latest.event_info.event_agentInfos:
        if event.HasField(kind):
            yield event


def until(competitor: Competitor, kind: str, times: int = 100, **actions: Any) -> EventAgent:
    """Play on until something happens to an agent."""
    for _ in range(times):
        competitor.act(**actions)
        for event in events_of(competitor, kind):
            return event
    raise AssertionError(f"no {kind} in {times} steps")


def test_nothing_is_told_to_who_has_not_asked(competitor: Competitor) -> None:
    assert not competitor.begin(duel()).HasField("event_info")
    assert not competitor.act(SHOOT).HasField("event_info")


def test_the_start_is_told_first(competitor: Competitor) -> None:
    request = competitor.begin(duel(is_Open_Event=True))
    assert request.event_info.timeStep == 0
    assert request.event_info.event_system.event_game_start.gameMode == GameMode.SUP_BATTLE_MODE
    request = competitor.act()
    assert request.event_info.timeStep == 5
    assert not request.event_info.HasField("event_system")


def test_a_hit_a_death_and_a_return_are_told(competitor: Competitor) -> None:
    competitor.begin(duel({"attack_power": 60}, is_Open_Event=True, respawn_time=1))
    competitor.act(SHOOT)
    (hit,) = events_of(competitor, "event_agent_beHited")
    assert hit.player_id == 1
    assert (hit.event_agent_beHited.damageValue, hit.event_agent_beHited.fire_id) == (60, 0)
    place = competitor.seen_by(1).location
    dead = until(competitor, "event_agent_dead", actions=SHOOT)
    assert (dead.player_id, dead.event_agent_dead.pos) == (1, place)
    back = until(competitor, "event_agent_refresh")
    assert (back.player_id, back.event_agent_refresh.pos) == (1, competitor.seen_by(1).location)


def test_a_hit_on_the_invincible_costs_nothing(competitor: Competitor) -> None:
    asked = duel({"attack_power": 100}, is_Open_Event=True, respawn_time=0, is_random_respawn_location=False)
    competitor.begin(asked)
    competitor.act(SHOOT)
    competitor.act(times=2)
    assert competitor.seen_by(1).is_invincible
    competitor.act(SHOOT)
    (hit,) = events_of(competitor, "event_agent_beHited")
    assert hit.event_agent_beHited.damageValue == 0
    assert competitor.seen_by(1).hp == 100


def test_a_reload_that_is_done_is_told(competitor: Competitor) -> None:
    competitor.begin(duel(is_Open_Event=True))
    competitor.act(SHOOT)
    competitor.act({0: {"reload": True}})
    assert competitor.seen_by(0).is_reload
    done = until(competitor, "event_agent_reload_success", times=20)
    seen = competitor.seen_by(0)
    assert (done.player_id, seen.is_reload) == (0, False)
    assert (seen.num_gun_ammo, seen.num_pack_ammo) == (15, 59)


def test_all_boxes_are_told_each_with_an_id_of_its_own(competitor: Competitor) -> None:
    competitor.begin(command(GameMode.SUP_GATHER_MODE, supply_random_min=2, supply_random_max=4))
    boxes = competitor.seen_by(0).supply_info_list
    assert len(boxes) > 20
    assert len({box.supply_id for box in boxes}) == len(boxes)
    # Indoors a box holds 10 by default, outdoors 2 to 4.
    assert {box.supply_quantity for box in boxes} == {2, 3, 4, 10}


def test_each_box_that_is_taken_is_told_with_who_took_it(competitor: Competitor) -> None:
    begin_at_a_box(competitor, duel(is_Open_Event=True))
    boxes = {box.supply_id: box for box in competitor.seen_by(0).supply_info_list}
    told = 0
    for _ in range(10):
        competitor.act({0: {"collect": True}, 1: {"collect": True, "walk_speed": 2}})
        for event in events_of(competitor, "event_get_supply_success"):
            found = event.event_get_supply_success
            box = boxes.pop(found.supply_id)
            assert (found.supply_count, found.pos) == (box.supply_quantity, box.supply_location)
            told += found.supply_count
    carried = [competitor.seen_by(agent).num_supply for agent in (0, 1)]
    assert told == sum(carried) > 0
    assert set(boxes) == {box.supply_id for box in competitor.seen_by(0).supply_info_list}


def test_a_refresh_is_told_with_its_place_and_its_boxes(competitor: Competitor) -> None:
    refresh = SupplyRefreshData(
        supply_heatmap_center=vector((5, 0, -5)),
        supply_heatmap_radius=50,
        supply_refresh_time=1,
        supply_create_percent=50,
        supply_house_create_percent=100,
    )
    asked = duel(is_Open_Event=True, supply_create_percent=0)
    asked.supply_refresh_datas.append(refresh)
    competitor.begin(asked)
    for _ in range(9):
        assert not competitor.act().event_info.event_system.HasField("event_supplyrefrsh")
    told = competitor.act().event_info.event_system.event_supplyrefrsh
    assert (told.pos.x, told.pos.z, told.id) == (5, -5, 1)
    assert told.count == len(competitor.seen_by(0).supply_info_list) > 0


def test_the_settlement_counts_kills_and_deaths(competitor: Competitor) -> None:
    competitor.begin(duel({"attack_power": 100}, is_Open_Event=True, timeout=1))
    competitor.act(SHOOT, times=100)
    players = competitor.latest.event_info.event_system.event_settle.event_player_infos
    assert [(player.kill_count, player.dead_count) for player in players] == [(1, 0), (0, 1)]


def test_who_carries_more_has_the_better_rank(competitor: Competitor) -> None:
    begin_at_a_box(competitor, duel(is_Open_Event=True))
    competitor.act({0: {"collect": True}})
    (event, *_) = events_of(competitor, "event_get_supply_success")
    assert (event.player_id, event.supply_num_rank) == (0, 1)
    for _ in range(20):
        competitor.act(SHOOT)
        for hit in events_of(competitor, "event_agent_beHited"):
            assert (hit.player_id, hit.supply_num_rank) == (1, 2)
            return
    raise AssertionError("no hit in 20 steps")


def test_the_settlement_ends_it(competitor: Competitor) -> None:
    asked = command(
        GameMode.SUP_GATHER_MODE,
        agents=[setup(0), setup(1)],
        is_Open_Event=True,
        timeout=1,
        supply_grid_length=1,
    )
    competitor.begin(asked)
    competitor.act({0: {"walk_dir": 90, "walk_speed": 3}, 1: {"collect": True}}, times=100)
    told = competitor.latest.event_info.event_system.event_settle
    assert competitor.is_over
    assert told.gameMode == GameMode.SUP_GATHER_MODE
    assert told.elapsed_time == 1.0
    players = told.event_player_infos
    assert [player.supply_count for player in players] == [
        competitor.seen_by(agent).num_supply for agent in (0, 1)
    ]
    assert (told.supply_count, told.move_distance) == (players[0].supply_count, players[0].move_distance)
    assert players[0].move_distance > 1
    assert {player.rank for player in players} <= {1, 2}
    assert min(player.rank for player in players) == 1
