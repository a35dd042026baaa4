"""What each tool does, why it ends, and what bad calls cost."""

import json
from collections.abc import Mapping
from typing import Any

import pytest
from tests.platform.language.flat_world import FlatWorld
from tests.platform.wildscav.skills.observations import enemy

from wildscav_language.calls import Reason
from wildscav_language.player import Player

TARGET = (0.0, 0.0, 30.0)


def shown(world: FlatWorld, **changes: Any) -> None:
    """Show an enemy 20 m to the east."""
    world.agents = (enemy((20.0, 0.0, 0.0), **changes),)


def test_a_walk_to_the_target_ends_there() -> None:
    world = FlatWorld(track="navigation", target=TARGET)
    world.changes = {"target": TARGET}

    reply = world.call("go", {"place": "target"})

    assert (reply.ended, reply.steps) == (Reason.ARRIVED, 30)
    assert "Target: 12 o'clock, bearing 0°" in reply.text or "Target: here" in reply.text


def test_a_walk_in_a_direction_lasts_as_long_as_it_may() -> None:
    world = FlatWorld(track="navigation", target=TARGET)

    reply = world.call("go", {"bearing": 90, "seconds": 2.0})

    assert (reply.ended, reply.steps) == (Reason.OUT_OF_TIME, 20)
    assert world.position == pytest.approx((20.0, 0.0, 0.0))


def test_a_wall_ends_a_walk_after_four_seconds() -> None:
    world = FlatWorld(track="navigation", target=TARGET)
    world.walled = True

    reply = world.call("go", {"bearing": 0, "seconds": 30.0})

    assert (reply.ended, reply.steps) == (Reason.STUCK, 40)


def test_a_box_is_fetched_and_others_on_the_way_are_taken() -> None:
    world = FlatWorld()
    world.put_box(3, (0.0, 0.0, 5.0))
    world.put_box(8, (0.0, 0.0, 10.0), 7)

    reply = world.call("pick_up", {"box": 8})

    assert reply.ended == Reason.DONE
    assert "You have what was in box 8." in reply.text
    assert world.boxes == {}


@pytest.mark.parametrize(
    ("event", "change", "reason"),
    [
        ("hit", {"hit_by_seat": 1}, Reason.HIT),
        ("died", {"alive": False, "health": 0, "respawn_in": 10.0}, Reason.DIED),
    ],
)
def test_what_happens_to_the_body_ends_a_walk(event: str, change: Mapping[str, Any], reason: Reason) -> None:
    world = FlatWorld()
    world.at[5] = lambda: setattr(world, "changes", change)

    reply = world.call("go", {"bearing": 0, "seconds": 30.0})

    assert (reply.ended, reply.steps) == (reason, 5)


@pytest.mark.parametrize(("stop_for", "reason"), [(["enemy"], Reason.ENEMY_SEEN), ([], Reason.OUT_OF_TIME)])
def test_an_enemy_ends_a_walk_if_the_caller_says_so(stop_for: list[str], reason: Reason) -> None:
    world = FlatWorld()
    world.at[5] = lambda: shown(world)

    assert world.call("go", {"bearing": 0, "seconds": 1.0, "stop_for": stop_for}).ended == reason


def test_exploring_ends_at_a_box() -> None:
    world = FlatWorld()
    world.at[5] = lambda: world.put_box(2, (50.0, 0.0, 50.0))

    reply = world.call("explore")

    assert (reply.ended, reply.steps) == (Reason.BOX_SEEN, 5)
    assert "You see box 2." in reply.text


def test_looking_around_is_a_full_turn() -> None:
    world = FlatWorld(track="navigation", target=TARGET)

    reply = world.call("look_around")

    assert (reply.ended, reply.steps) == (Reason.DONE, 8)  # of 45 degrees
    assert world.yaw == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("arguments", "yaw"), [({"bearing": 200}, -160.0), ({"right": -30}, -30.0)])
def test_turning(arguments: Mapping[str, float], yaw: float) -> None:
    world = FlatWorld(track="navigation", target=TARGET)

    assert world.call("turn", arguments).ended == Reason.DONE
    assert world.yaw == pytest.approx(yaw)


def test_waiting_for_what_does_not_happen_ends_in_time() -> None:
    world = FlatWorld()

    reply = world.call("wait_until", {"event": "enemy", "seconds": 1.5})

    assert (reply.ended, reply.steps) == (Reason.OUT_OF_TIME, 15)


def test_an_attack_shoots_and_ends_when_the_enemy_is_out_of_sight_for_long() -> None:
    world = FlatWorld()
    shown(world)
    world.at[10] = lambda: setattr(world, "agents", ())

    reply = world.call("attack", {"agent": 1})

    assert reply.ended == Reason.DONE
    assert "Agent 1 is not in sight any more." in reply.text
    assert any(action.shoot for action in world.actions[:10])


def test_who_holds_fire_shoots_at_nobody() -> None:
    world = FlatWorld()
    shown(world)

    world.call("hold_fire")
    world.call("go", {"bearing": 0, "seconds": 1.0, "stop_for": []})

    assert not any(action.shoot for action in world.actions)


def test_a_follower_keeps_its_distance() -> None:
    world = FlatWorld()
    shown(world)

    world.call("follow", {"agent": 1, "metres": 5.0, "seconds": 5.0})

    assert world.position[0] == pytest.approx(15.0, abs=1.1)


def test_cover_is_from_an_enemy() -> None:
    world = FlatWorld()
    shown(world)

    reply = world.call("take_cover", {"seconds": 2.0})

    assert (reply.ended, "no cover" in reply.text) == (Reason.OUT_OF_TIME, True)
    assert world.position[0] < -15.0  # so it runs


def test_the_dead_wait_until_they_come_back() -> None:
    world = FlatWorld()
    world.changes = {"alive": False, "health": 0, "respawn_in": 0.5}
    world.at[5] = lambda: setattr(world, "changes", {})

    reply = world.call("go", {"bearing": 0})

    assert (reply.ended, reply.steps) == (Reason.DONE, 5)
    assert world.player.counts.refused == 0


@pytest.mark.parametrize(
    ("name", "arguments", "sentence"),
    [
        ("fly", {}, "There is no tool 'fly' here; the tools are look_around, turn, go,"),
        (
            "go",
            {"bearing": 0, "seconds": 500},
            "go refuses seconds 500: Input should be less than or equal to 60",
        ),
        ("go", {}, "go refuses the arguments {}: Value error, give exactly one of bearing, box and place."),
        ("go", {"bearing": 0, "speed": 3}, "go refuses speed 3: Extra inputs are not permitted."),
        ("go", {"bearing": "north"}, "go refuses bearing 'north': Input should be a valid number"),
        ("go", {"bearing": float("nan")}, "go refuses bearing nan: "),
        ("go", {"place": "the moon"}, "There is no such place; known places are start, wave 1."),
        ("pick_up", {"box": 99}, "Box 99 is not known; known boxes are none yet."),
        ("pick_up", {}, "No box is known and none is within reach; look around or explore."),
        ("attack", {"agent": 7}, "Agent 7 has not been seen; seen so far: nobody."),
        ("attack", {}, "No enemy is in sight; look around, or name one that you have seen."),
        ("take_cover", {}, "No enemy has been seen; cover is from an enemy."),
        ("reload", {}, "The clip is full with 15 rounds."),
        ("x" * 10_000, {}, f"There is no tool '{'x' * 40}' here"),
        ("go", {"place": "y" * 10_000}, "go refuses place 'yyy"),
    ],
)
def test_a_bad_call_gets_a_sentence_and_costs_half_a_second(
    name: str, arguments: Mapping[str, Any], sentence: str
) -> None:
    world = FlatWorld()

    reply = world.call(name, arguments)

    assert (reply.ended, reply.steps) == (Reason.REFUSED, 5)
    first = reply.text.partition("\n")[0]
    assert sentence in first
    assert len(first) < 500
    assert all(action.walk_speed == 0.0 for action in world.actions)
    assert (world.player.counts.calls, world.player.counts.refused) == (1, 1)


def test_a_call_that_has_nothing_to_do_takes_a_step() -> None:
    world = FlatWorld()

    reply = world.call("turn", {"bearing": 0})

    assert (reply.ended, reply.steps) == (Reason.DONE, 1)


@pytest.mark.parametrize(
    ("match", "absent"),
    [
        ({"track": "navigation", "seats": 1}, {"pick_up", "attack", "follow", "reload"}),
        ({"track": "gathering"}, {"attack", "reload", "take_cover"}),
        ({"track": "battle"}, set()),
        ({"track": "battle", "senses": "pixels"}, {"attack", "follow"}),
    ],
)
def test_tools_follow_track_and_senses(match: Mapping[str, Any], absent: set[str]) -> None:
    everything = {tool.name for tool in FlatWorld(track="royale").player.tools}
    player: Player = FlatWorld(**match).player

    assert {tool.name for tool in player.tools} <= everything - absent
    for tool in player.tools:
        assert tool.description
        assert json.dumps(tool.schema)
        assert tool.schema["additionalProperties"] is False
