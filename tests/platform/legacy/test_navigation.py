"""Navigation by the original's contract: moving, the target, the clock, episode after episode."""

import math

import pytest
from tests.platform.legacy.helpers.commands import command, far_target, open_way, setup
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_engine.maps import load_map
from wildscav_engine.record import read_record, verify_record
from wildscav_legacy.commander_pb2 import AgentSetup, GameState


def test_an_episode_opens_with_what_the_agent_starts_with(competitor: Competitor) -> None:
    start = open_way(12)
    request = competitor.begin(command(agents=[setup(start=start)], target=far_target()))
    assert (request.game_state, request.time_step) == (GameState.UPDATE, 0)
    seen = competitor.seen_by(0)
    assert [seen.location.x, seen.location.y, seen.location.z] == pytest.approx(start, abs=0.01)
    assert (seen.hp, seen.num_gun_ammo, seen.num_pack_ammo, seen.num_supply) == (100, 15, 60, 0)
    assert (seen.yaw, seen.pitch, seen.move_speed) == (0, 0, 0)
    assert seen.on_ground
    assert not any((seen.is_fire, seen.is_reload, seen.is_waiting_respawn, seen.is_invincible))
    assert not seen.HasField("image")


def test_to_walk_north_at_5_metres_a_second_for_2_seconds_leads_10_metres_north(
    competitor: Competitor,
) -> None:
    start = open_way(12)
    competitor.begin(command(agents=[setup(start=start)], target=far_target()))
    request = competitor.act({0: {"walk_dir": 0, "walk_speed": 5}}, times=20)
    seen = competitor.seen_by(0)
    assert request.time_step == 100, "20 actions are 100 frames: 2 s"
    assert seen.location.z - start[2] == pytest.approx(10.0, abs=0.01)
    assert seen.location.x == pytest.approx(start[0], abs=0.01)
    assert (seen.move_dir.x, seen.move_dir.z) == pytest.approx((0, 1), abs=0.01)
    assert seen.move_speed == pytest.approx(5, abs=0.01)


def test_turns_are_degrees_a_frame(competitor: Competitor) -> None:
    competitor.begin(command(target=far_target()))
    competitor.act({0: {"turn_left_right_delta": 2, "look_up_down_delta": -1.5}}, times=3)
    seen = competitor.seen_by(0)
    assert (seen.yaw, seen.pitch) == pytest.approx((30, -22.5)), "3 actions of 5 frames"


def test_the_walk_of_the_originals_example_arrives(competitor: Competitor) -> None:
    """Its default: on map 1 from the middle to (5, 0, 5), at 1 m/s, in 10 s."""
    competitor.begin(command(map_id=1, target=(5, 0, 5), timeout=10))
    for _ in range(100):
        place = competitor.seen_by(0).location
        direction = math.degrees(math.atan2(5 - place.x, 5 - place.z))
        competitor.act({0: {"walk_dir": direction, "walk_speed": 1}})
    assert competitor.is_over
    assert competitor.latest.time_step < 500


@pytest.mark.parametrize("way", [1, -1])
def test_straight_up_and_down_is_not_told_quite(competitor: Competitor, way: int) -> None:
    """The client's raycaster, which looks along the pitch that it is told, has no right and left there."""
    competitor.begin(command(target=far_target()))
    competitor.act({0: {"look_up_down_delta": 20 * way}}, times=2)
    assert competitor.seen_by(0).pitch == pytest.approx(89.99 * way, abs=1e-4)
    assert abs(competitor.seen_by(0).pitch) < 90


def test_the_target_ends_the_episode_in_the_frame_in_which_it_is_reached(competitor: Competitor) -> None:
    start = open_way(12)
    target = [start[0], start[1], start[2] + 8]
    competitor.begin(command(agents=[setup(start=start)], target=target, trigger_range=3))
    request = competitor.act({0: {"walk_dir": 0, "walk_speed": 10}}, times=100)
    seen = competitor.seen_by(0)
    assert competitor.is_over
    # The way to 3 m before the target, at 0.2 m a frame; on a slope some of the distance is height.
    assert 20 <= request.time_step <= 27
    left = (seen.location.x - target[0], seen.location.z - target[2])
    assert left[0] ** 2 + left[1] ** 2 <= 3**2


def test_episodes_follow_each_other_on_any_maps_even_where_one_is_interrupted(competitor: Competitor) -> None:
    competitor.begin(command(timeout=1))
    competitor.act(times=10)
    assert competitor.is_over
    assert competitor.begin(command(map_id=104, timeout=1)).time_step == 0
    competitor.act(times=3)
    assert not competitor.is_over
    request = competitor.begin(command(agents=[setup(0), setup(1)], timeout=1))
    assert (request.game_state, request.time_step, len(request.agent_obs_list)) == (GameState.UPDATE, 0, 2)


@pytest.mark.parametrize("map_id", [103, 104])
def test_an_agent_without_a_start_is_at_a_location_of_the_episodes_map(
    competitor: Competitor, map_id: int
) -> None:
    competitor.begin(command(agents=[AgentSetup(id=0)], map_id=map_id))
    place = competitor.seen_by(0).location
    ways = load_map(map_id).world.spawns - (place.x, place.y, place.z)
    assert abs(ways).sum(axis=1).min() < 0.01


def test_who_goes_on_after_the_end_is_told_the_end_again(competitor: Competitor) -> None:
    competitor.begin(command(timeout=1))
    competitor.act(times=9)
    assert not competitor.is_over
    last = competitor.act()
    assert (competitor.is_over, last.time_step) == (True, 50)
    competitor.reply(GameState.UPDATE)
    assert competitor.wait() == last
    assert competitor.begin(command(timeout=1)).time_step == 0


def test_a_record_is_there_before_the_client_hears_of_the_end(competitor: Competitor) -> None:
    agents = [setup(0), AgentSetup(id=5, agent_name="fox")]
    competitor.begin(command(agents=agents, timeout=1, is_record=True, replay_suffix="/../odd name"))
    competitor.act(times=10)
    (path,) = competitor.records.glob("*.wsr")
    assert path.stem.endswith("_.._odd_name")
    record = read_record(path)
    assert (record.steps, record.names) == (10, ("agent_0", "fox"))
    assert verify_record(record).holds


def test_an_episode_that_is_interrupted_leaves_no_record(competitor: Competitor) -> None:
    before = list(competitor.records.glob("*"))
    competitor.begin(command(timeout=1, is_record=True))
    competitor.act(times=5)
    competitor.begin(command(timeout=1))
    assert list(competitor.records.glob("*")) == before


def test_one_seed_gives_one_episode(competitor: Competitor) -> None:
    asked = command(random_seed=-7, timeout=1)
    asked.agent_setups[0].ClearField("start_location")
    first = competitor.begin(asked)
    assert competitor.begin(asked) == first
    asked.random_seed = 8
    assert competitor.begin(asked).agent_obs_list[0].location != first.agent_obs_list[0].location


def test_the_default_start_in_the_middle_of_the_map_is_where_one_can_stand(competitor: Competitor) -> None:
    competitor.begin(command(agents=[setup(start=(0, -50, 0))], target=far_target()))
    competitor.act(times=20)
    place = competitor.seen_by(0).location
    assert competitor.seen_by(0).on_ground
    assert place.x**2 + place.z**2 < 15**2


def test_an_action_of_nobody_and_a_speed_beyond_the_fastest_hold_nothing_up(competitor: Competitor) -> None:
    start = open_way(12)
    competitor.begin(command(agents=[setup(start=start)], target=far_target()))
    competitor.act({7: {"walk_speed": 3}, 0: {"walk_speed": 30}}, times=5)
    assert competitor.seen_by(0).location.z - start[2] == pytest.approx(5.0, abs=0.01), "0.5 s at 10 m/s"
