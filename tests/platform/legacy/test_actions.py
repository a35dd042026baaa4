"""What each field of an ``AgentCommand`` does."""

import math

import pytest
from tests.platform.legacy.helpers.commands import command, far_target, open_way, setup
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_legacy.commander_pb2 import AgentCommand, GameMode, GameState, GMCommand


def walk_from(start: list[float], **fields: float) -> GMCommand:
    return command(agents=[setup(start=start)], target=far_target(), **fields)


@pytest.mark.parametrize(
    ("direction", "x", "z"), [(0, 0, 3), (90, 3, 0), (180, 0, -3), (-90, -3, 0), (450, 3, 0)]
)
def test_walk_dir_is_a_compass_direction_wherever_the_agent_looks(
    competitor: Competitor, direction: float, x: float, z: float
) -> None:
    start = open_way(4, direction % 360)
    competitor.begin(walk_from(start))
    competitor.act({0: {"turn_left_right_delta": 10}}, times=1)
    competitor.act({0: {"walk_dir": direction, "walk_speed": 5}}, times=6)
    place = competitor.seen_by(0).location
    assert (place.x - start[0], place.z - start[2]) == pytest.approx((x, z), abs=0.01)


def test_a_jump_leaves_the_ground_and_ends_on_it(competitor: Competitor) -> None:
    start = open_way(12)
    competitor.begin(walk_from(start))
    competitor.act({0: {"jump": True}}, times=3)
    assert competitor.seen_by(0).location.y > start[1] + 0.8
    assert not competitor.seen_by(0).on_ground
    competitor.act(times=15)
    assert competitor.seen_by(0).location.y == pytest.approx(start[1], abs=0.01)
    assert competitor.seen_by(0).on_ground


@pytest.mark.parametrize("field", ["walk_dir", "walk_speed", "turn_left_right_delta", "look_up_down_delta"])
def test_an_action_that_is_not_finite_does_nothing(competitor: Competitor, field: str) -> None:
    competitor.begin(walk_from(open_way(12)))
    competitor.act()
    before = competitor.seen_by(0)
    fields = {"walk_dir": 0.0, "walk_speed": 5.0, "turn_left_right_delta": 1.0, field: math.nan}
    competitor.act({0: fields})
    after = competitor.seen_by(0)
    assert (after.location, after.yaw, after.pitch) == (before.location, before.yaw, before.pitch)


@pytest.mark.parametrize("mode", [GameMode.NAVIGATION_MODE, GameMode.SUP_GATHER_MODE])
def test_nobody_shoots_in_navigation_and_gathering(competitor: Competitor, mode: GameMode) -> None:
    competitor.begin(command(mode, supply_create_percent=0, supply_house_create_percent=0))
    competitor.act({0: {"shoot_gun": True, "collect": True}})
    seen = competitor.seen_by(0)
    assert (seen.num_gun_ammo, seen.is_fire, seen.can_pickup, seen.num_supply) == (15, False, False, 0)


def test_who_is_not_in_the_commands_stands_still_and_of_two_the_last_counts(competitor: Competitor) -> None:
    start = open_way(12)
    competitor.begin(command(agents=[setup(4, start), setup(9, start)], target=far_target()))
    orders = [AgentCommand(id=4, walk_speed=5), AgentCommand(id=4, walk_speed=0)]
    competitor.reply(GameState.UPDATE, agent_cmd_list=orders)
    competitor.wait()
    assert [competitor.seen_by(agent).move_speed for agent in (4, 9)] == [0, 0]
