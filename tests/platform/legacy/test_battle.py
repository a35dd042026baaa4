"""Supply battle by the original's contract: shots, deaths, returns, and what each agent was given."""

from tests.platform.legacy.helpers.commands import SHOOT, command, duel, face_to_face, setup
from tests.platform.legacy.helpers.competitor import Competitor, begin_at_a_box

from wildscav_legacy.commander_pb2 import EnemyInfo, GameMode, Observation, Vector3


def test_a_hit_costs_20_and_both_are_told(competitor: Competitor) -> None:
    competitor.begin(duel())
    competitor.act(SHOOT)
    shooter, victim = competitor.seen_by(0), competitor.seen_by(1)
    assert (shooter.num_gun_ammo, shooter.num_pack_ammo, shooter.is_fire) == (14, 60, True)
    assert (shooter.hit_enemy, shooter.hit_enemy_id, shooter.hit_by_enemy) == (True, 1, False)
    assert (victim.hp, victim.hit_by_enemy, victim.hit_by_enemy_id, victim.hit_enemy) == (80, True, 0, False)
    competitor.act()
    assert not competitor.seen_by(0).hit_enemy
    assert not competitor.seen_by(1).hit_by_enemy


def test_the_dead_wait_come_back_whole_and_are_invincible_for_a_while(competitor: Competitor) -> None:
    competitor.begin(duel({"attack_power": 100}, {"hp": 70}, respawn_time=1, invincible_time=2))
    competitor.act(SHOOT)
    seen = competitor.seen_by(1)
    assert (seen.hp, seen.is_waiting_respawn, seen.is_invincible) == (0, True, False)
    (enemy,) = competitor.seen_by(0).enemy_info_list
    assert (enemy.enemy_id, enemy.hp, enemy.is_respawn) == (1, 0, True)
    competitor.act(times=11)
    seen = competitor.seen_by(1)
    assert (seen.hp, seen.is_waiting_respawn, seen.is_invincible) == (70, False, True)
    (enemy,) = competitor.seen_by(0).enemy_info_list
    assert (enemy.hp, enemy.is_respawn, enemy.is_invincible) == (70, False, True)
    competitor.act(times=20)
    assert not competitor.seen_by(1).is_invincible


def test_each_has_ammunition_of_its_own_and_boxes_dropped_at_a_death_have_new_ids(
    competitor: Competitor,
) -> None:
    begin_at_a_box(competitor, duel({"num_pack_ammo": 1}, {"attack_power": 100, "gun_capacity": 2}))
    competitor.act({0: {"collect": True}, 1: {"turn_left_right_delta": 36}})
    before = competitor.seen_by(0)
    competitor.act({1: {"shoot_gun": True}})
    after, shooter = competitor.seen_by(0), competitor.seen_by(1)
    assert (after.hp, after.num_gun_ammo, after.num_pack_ammo) == (0, 15, 1)
    assert (shooter.num_gun_ammo, shooter.num_pack_ammo) == (1, 60)
    assert after.num_supply == before.num_supply / 2 >= 5
    known = {box.supply_id for box in before.supply_info_list}
    dropped = [box.supply_quantity for box in after.supply_info_list if box.supply_id not in known]
    assert sum(dropped) == before.num_supply - after.num_supply


def test_ten_agents_are_told_of_all_others(competitor: Competitor) -> None:
    competitor.begin(command(GameMode.SUP_BATTLE_MODE, agents=[setup(agent) for agent in range(10)]))
    competitor.act({agent: {"walk_dir": 36 * agent, "walk_speed": 5} for agent in range(10)}, times=10)
    assert len(competitor.latest.agent_obs_list) == 10
    motions = {one.id: motion_of(one) for one in competitor.latest.agent_obs_list}
    assert max(speed for _, _, speed in motions.values()) > 4
    for seen in competitor.latest.agent_obs_list:
        others = {enemy.enemy_id: motion_of(enemy) for enemy in seen.enemy_info_list}
        assert others == {agent: motion for agent, motion in motions.items() if agent != seen.id}


def motion_of(one: Observation | EnemyInfo) -> tuple[Vector3, Vector3, float]:
    return one.location, one.move_dir, one.move_speed


def test_agents_are_called_what_the_client_calls_them(competitor: Competitor) -> None:
    here, there = face_to_face()
    agents = [setup(7, here), setup(3, there)]
    competitor.begin(command(GameMode.SUP_BATTLE_MODE, agents=agents))
    competitor.act({7: {"shoot_gun": True}})
    assert competitor.seen_by(7).hit_enemy_id == 3
    assert competitor.seen_by(3).hit_by_enemy_id == 7
