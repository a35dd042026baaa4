"""What each tool does, why it ends, and what bad calls cost."""

import json
from collections.abc import Mapping
from typing import Any

import pytest
from tests.platform.language.flat_world import FlatWorld
from tests.platform.wildscav.skills.observations import enemy

from wildscav import SupplyBox, Vector, VisibleAgent
from wildscav_language.calls import Reason
from wildscav_language.player import Player

TARGET = (0.0, 0.0, 30.0)
EAST = enemy((20.0, 0.0, 0.0))
HIT, DEAD = {"hit_by_seat": 1}, {"alive": False, "health": 0, "respawn_in": 10.0}
NORTH = {"bearing": 0, "seconds": 30.0}


def seeing(*agents: VisibleAgent) -> FlatWorld:
    world = FlatWorld()
    world.agents = agents
    return world


@pytest.mark.parametrize(
    ("now", "later", "call", "arguments", "reason", "steps"),
    [
        ({"changes": {"target": TARGET}}, {}, "go", {"place": "target"}, Reason.ARRIVED, 30),
        ({}, {}, "go", {"bearing": 90, "seconds": 2.0}, Reason.OUT_OF_TIME, 20),
        ({"walled": True}, {}, "go", NORTH, Reason.STUCK, 40),  # after four seconds
        ({}, {"changes": HIT}, "go", NORTH, Reason.HIT, 5),
        ({}, {"changes": DEAD}, "go", NORTH, Reason.DIED, 5),
        ({}, {"agents": (EAST,)}, "go", NORTH | {"stop_for": ["enemy"]}, Reason.ENEMY_SEEN, 5),
        (
            {},
            {"agents": (EAST,)},
            "go",
            {"bearing": 0, "seconds": 1.0, "stop_for": []},
            Reason.OUT_OF_TIME,
            10,
        ),
        ({}, {"boxes": {2: SupplyBox(2, (50.0, 0.0, 50.0), 5)}}, "explore", {}, Reason.BOX_SEEN, 5),
        ({}, {}, "look_around", {}, Reason.DONE, 8),  # of 45 degrees
        ({}, {}, "wait_until", {"event": "enemy", "seconds": 1.5}, Reason.OUT_OF_TIME, 15),
        ({"changes": DEAD}, {"changes": {}}, "go", {"bearing": 0}, Reason.DONE, 5),  # back to life
        ({}, {}, "turn", {"bearing": 0}, Reason.DONE, 1),  # a call takes a step even if it has nothing to do
    ],
)
def test_a_tool_ends_for_a_reason(
    now: dict[str, Any],
    later: dict[str, Any],
    call: str,
    arguments: Mapping[str, Any],
    reason: Reason,
    steps: int,
) -> None:
    """``later`` is what changes in the fifth step."""
    world = FlatWorld(target=TARGET)
    vars(world).update(now)
    world.at[5] = lambda: vars(world).update(later)

    reply = world.call(call, arguments)

    assert (reply.ended, reply.steps) == (reason, steps)
    assert ("You see box 2." in reply.text) == (reason == Reason.BOX_SEEN)
    assert world.player.counts.refused == 0


@pytest.mark.parametrize(
    ("call", "arguments", "place", "yaw"),
    [
        ("go", {"bearing": 90, "seconds": 2.0}, (20.0, 0.0, 0.0), 90.0),
        ("turn", {"bearing": 200}, (0.0, 0.0, 0.0), -160.0),
        ("turn", {"right": -30}, (0.0, 0.0, 0.0), -30.0),
        ("look_around", {}, (0.0, 0.0, 0.0), 0.0),  # a full turn
    ],
)
def test_where_a_tool_leads(call: str, arguments: Mapping[str, float], place: Vector, yaw: float) -> None:
    world = FlatWorld(track="navigation", target=TARGET)

    world.call(call, arguments)

    assert world.position == pytest.approx(place)
    assert world.yaw == pytest.approx(yaw, abs=1e-9)


@pytest.mark.parametrize(
    ("call", "arguments", "yaw"),
    [
        ("turn", {"right": 180}, -180.0),
        ("look_around", {}, 0.0),  # a full turn
    ],
)
def test_an_enemy_in_sight_does_not_keep_a_seat_from_turning(
    call: str, arguments: Mapping[str, float], yaw: float
) -> None:
    world = seeing(EAST)

    reply = world.call(call, arguments)

    assert reply.ended == Reason.DONE
    assert world.yaw == pytest.approx(yaw)
    assert sum(abs(5 * action.turn) for action in world.actions) == pytest.approx(abs(yaw) or 360.0)


def test_a_reply_tells_where_the_target_is_and_what_was_seen() -> None:
    world = FlatWorld(track="navigation", target=TARGET)
    world.changes = {"target": TARGET}

    text = world.call("go", {"place": "target"}).text

    assert "Target: 12 o'clock, bearing 0°" in text or "Target: here" in text


def test_a_box_is_fetched_and_others_on_the_way_are_taken() -> None:
    world = FlatWorld()
    world.put_box(3, (0.0, 0.0, 5.0))
    world.put_box(8, (0.0, 0.0, 10.0), 7)

    reply = world.call("pick_up", {"box": 8})

    assert reply.ended == Reason.DONE
    assert "You have what was in box 8." in reply.text
    assert world.boxes == {}


def test_an_attack_shoots_and_ends_when_the_enemy_is_out_of_sight_for_long() -> None:
    world = seeing(EAST)
    world.at[10] = lambda: setattr(world, "agents", ())

    reply = world.call("attack", {"agent": 1})

    assert reply.ended == Reason.DONE
    assert "Agent 1 is not in sight any more." in reply.text
    assert any(action.shoot for action in world.actions[:10])


def test_who_holds_fire_shoots_at_nobody() -> None:
    world = seeing(EAST)

    world.call("hold_fire")
    world.call("go", {"bearing": 0, "seconds": 1.0, "stop_for": []})

    assert not any(action.shoot for action in world.actions)


def test_a_follower_keeps_its_distance() -> None:
    world = seeing(EAST)

    world.call("follow", {"agent": 1, "metres": 5.0, "seconds": 5.0})

    assert world.position[0] == pytest.approx(15.0, abs=1.1)


def test_cover_is_from_an_enemy() -> None:
    world = seeing(EAST)

    reply = world.call("take_cover", {"seconds": 2.0})

    assert (reply.ended, "no cover" in reply.text) == (Reason.OUT_OF_TIME, True)
    assert world.position[0] < -15.0  # so it runs


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


@pytest.mark.parametrize(
    ("match", "absent"),
    [
        ({"track": "navigation", "seats": 1}, {"pick_up", "attack", "follow", "reload"}),
        ({"track": "gathering"}, {"attack", "reload", "take_cover"}),
        ({"track": "battle"}, set()),
        ({"track": "battle", "senses": "pixels"}, {"attack", "follow", "hold_fire", "take_cover"}),
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
