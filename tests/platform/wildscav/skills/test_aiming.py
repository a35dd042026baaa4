"""Aiming: where an enemy will be, seen from where the agent will be, and when a shot will hit."""

import math

import pytest
from tests.platform.wildscav.skills.observations import NOWHERE, enemy, match_info, seen

from wildscav.skills.aiming import (
    MAX_TURN,
    Lookout,
    Thrift,
    aim_at,
    enemies_in_sight,
    look_around,
    max_turn_of,
    threats_first,
    velocity_of,
    will_hit,
)

FRAMES = 5  # 0.1 s


def test_an_enemy_straight_ahead_is_shot_at_once() -> None:
    aim = aim_at(seen(), enemy((0.0, 0.0, 10.0)), NOWHERE, FRAMES)

    assert aim.turn == 0.0
    assert aim.shoot


def test_a_moving_target_is_led() -> None:
    aim = aim_at(seen(), enemy((0.0, 0.0, 10.0), velocity=(5.0, 0.0, 0.0)), NOWHERE, FRAMES)

    assert aim.turn * FRAMES == pytest.approx(math.degrees(math.atan2(0.5, 10.0)))  # 5 m/s for 0.1 s


def test_the_agents_own_motion_counts_as_much_as_the_enemys() -> None:
    still = aim_at(seen(), enemy((0.0, 0.0, 10.0), velocity=(5.0, 0.0, 0.0)), (5.0, 0.0, 0.0), FRAMES)
    moving = aim_at(seen(), enemy((0.0, 0.0, 10.0)), velocity_of(270.0, 5.0), FRAMES)

    assert still.turn == pytest.approx(0.0)
    assert moving.turn * FRAMES == pytest.approx(math.degrees(math.atan2(0.5, 10.0)))


@pytest.mark.parametrize(
    ("yaw", "shoots"),
    [
        (0.0, True),
        (1.5, True),  # the body is 2.6 degrees wide to each side at 10 m, of which four fifths count
        (6.0, False),
        (90.0, False),
    ],
)
def test_it_shoots_only_if_it_hits(yaw: float, shoots: bool) -> None:
    assert aim_at(seen(yaw=yaw), enemy((0.0, 0.0, 10.0)), NOWHERE, FRAMES).shoot is shoots


@pytest.mark.parametrize(
    ("turn", "look", "hits"),
    [
        (0.0, 0.0, True),
        (0.3, 0.0, True),  # 1.5 degrees at the end of the step
        (0.6, 0.0, False),  # 3 degrees, which is beside it
        (0.0, 2.0, False),  # 10 degrees below it
    ],
)
def test_a_shot_hits_only_if_the_enemy_stays_in_the_sights_while_they_turn(
    turn: float, look: float, hits: bool
) -> None:
    assert will_hit(seen(), enemy((0.0, 0.0, 10.0)), NOWHERE, FRAMES, turn, look) is hits


def test_turns_are_limited() -> None:
    assert aim_at(seen(yaw=-179.0), enemy((0.0, 0.0, 10.0)), NOWHERE, 1).turn == MAX_TURN


def test_an_unseen_shooter_is_looked_for_faster() -> None:
    assert look_around(seen(hit_by_seat=3), FRAMES).turn > look_around(seen(), FRAMES).turn


def test_the_invincible_and_teammates_are_no_targets() -> None:
    agents = (enemy(NOWHERE, invincible=True), enemy(NOWHERE, team=0), enemy((9.0, 0.0, 0.0), seat=4))

    assert [agent.seat for agent in enemies_in_sight(seen(agents=agents), team=0)] == [4]


def test_the_most_dangerous_come_first() -> None:
    near = enemy((0.0, 0.0, 5.0), seat=1, yaw=0.0)  # looks away
    watcher = enemy((0.0, 0.0, 20.0), seat=2, yaw=180.0)
    shooter = enemy((30.0, 0.0, 0.0), seat=3, yaw=90.0)

    ordered = threats_first(seen(hit_by_seat=3), [near, watcher, shooter])

    assert [agent.seat for agent in ordered] == [3, 2, 1]


@pytest.mark.parametrize(
    ("hits", "time", "shoots"),
    [
        ([None, None], 1.0, True),
        ([None, None, None], 1.0, False),  # three misses in a row
        ([None, None, 1, None], 1.0, True),  # a hit in between
        ([None, None, None], 4.5, True),  # 3 s later
    ],
)
def test_rounds_are_saved_on_an_enemy_that_they_miss(
    hits: list[int | None], time: float, shoots: bool
) -> None:
    thrift, target = Thrift(), enemy((0.0, 0.0, 10.0))
    for hit in hits:
        thrift.may_shoot(seen(time=1.0), target)
        thrift.look(seen(time=1.0, fired=True, hit_seat=hit))

    assert thrift.may_shoot(seen(time=time), target) is shoots
    assert thrift.may_shoot(seen(time=time), enemy((0.0, 0.0, 10.0), seat=2))


def watched(*steps: tuple[float, tuple[float, float, float]], senses: str = "sighted") -> tuple[float, ...]:
    """The velocity that an enemy has for who has seen it at some times in some places, the last one now."""
    lookout, enemies = Lookout(match_info(senses=senses)), []
    for time, place in steps:
        enemies = lookout.enemies(seen(time=time, agents=(enemy(place, velocity=(0.0, 0.0, 9.0)),)))
    return enemies[0].velocity


def test_who_is_not_told_velocities_sees_them() -> None:
    before = (1.0, (0.0, 0.0, 10.0))
    assert watched(before, (1.1, (0.5, 0.0, 10.0))) == pytest.approx((5.0, 0.0, 0.0))
    assert watched(before, (1.1, (0.5, 0.0, 10.0)), senses="original") == (0.0, 0.0, 9.0)
    assert watched(before) == NOWHERE
    assert watched(before, (2.0, (0.5, 0.0, 10.0))) == NOWHERE, "too long ago"
    assert watched(before, (1.1, (5.0, 0.0, 10.0))) == NOWHERE, "it has respawned"


def test_nobody_plans_a_turn_that_the_rules_cut_off() -> None:
    limit = max_turn_of(match_info(turn_speed=360.0))
    aim = aim_at(seen(yaw=180.0), enemy((0.0, 0.0, 10.0)), NOWHERE, FRAMES, limit)

    assert limit == pytest.approx(7.2)
    assert abs(aim.turn) == pytest.approx(7.2)
    assert max_turn_of(match_info()) == MAX_TURN
