"""What a page may send, and what becomes of it."""

import json
from typing import Any

import pytest
from pydantic import BaseModel

from wildscav.agent import Action
from wildscav_stage.playing.inputs import (
    MAX_ROBOTS,
    Arrange,
    Controls,
    Free,
    Input,
    InputError,
    OpenRoom,
    Pause,
    Ready,
    Rename,
    Seen,
    Start,
    decode_message,
)


def given(**fields: Any) -> Input:
    return Input(kind="input", **{"number": 1, **fields})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            '{"kind": "input", "number": 7, "forward": 1, "turn": -3.5, "shoot": true}',
            given(number=7, forward=1.0, turn=-3.5, shoot=True),
        ),
        ('{"kind": "seen", "number": 4}', Seen(kind="seen", number=4)),
        ('{"kind": "start"}', Start(kind="start")),
        ('{"kind": "rename", "name": "Ada"}', Rename(kind="rename", name="Ada")),
        ('{"kind": "free", "seat": 2}', Free(kind="free", seat=2)),
        ('{"kind": "room", "open": true}', OpenRoom(kind="room", open=True)),
        ('{"kind": "ready", "ready": true}', Ready(kind="ready", ready=True)),
        (
            '{"kind": "arrange", "robots": ["fighter"], "new_map": false}',
            Arrange(kind="arrange", robots=("fighter",), new_map=False),
        ),
        ('{"kind": "pause", "paused": true}', Pause(kind="pause", paused=True)),
    ],
)
def test_every_kind_of_message_is_read(text: str, message: BaseModel) -> None:
    assert decode_message(text) == message


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"kind": "record"}',
        '{"kind": "start", "seat": 1}',  # nobody chooses a seat
        '{"kind": "input"}',
        '{"kind": "input", "number": -1}',
        '{"kind": "input", "number": 1, "forward": 1.5}',
        '{"kind": "input", "number": 1, "turn": NaN}',
        '{"kind": "input", "number": 1, "look": 1e400}',
        '{"kind": "input", "number": 1, "shoot": 1}',
        '{"kind": "input", "number": 1, "teleport": true}',
        '{"kind": "input", "number": 1, "seat": 1}',  # nor acts for another
        '{"kind": "rename", "name": 5}',
        f'{{"kind": "rename", "name": "{"x" * 101}"}}',
        '{"kind": "free", "seat": -1}',
        json.dumps({"kind": "arrange", "robots": ["walker"] * (MAX_ROBOTS + 1), "new_map": False}),
        "[" * 4000,
        '{"kind": "watch", "seat": 1}',  # nor chooses what to be told
    ],
)
def test_anything_else_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        decode_message(text)


@pytest.mark.parametrize(
    ("forward", "right", "yaw", "direction", "speed"),
    [
        (1.0, 0.0, 30.0, 30.0, 10.0),
        (-1.0, 0.0, 30.0, -150.0, 10.0),
        (0.0, 1.0, 30.0, 120.0, 10.0),
        (1.0, -1.0, 0.0, -45.0, 10.0),  # two keys at once are no faster
        (0.5, 0.0, 0.0, 0.0, 5.0),  # a stick that is pushed half-way
        (0.0, 0.0, 30.0, 0.0, 0.0),
    ],
)
def test_walking_is_relative_to_the_view(
    forward: float, right: float, yaw: float, direction: float, speed: float
) -> None:
    controls = Controls()
    controls.receive(given(forward=forward, right=right))
    action = controls.take(yaw, frames=1)
    assert action.walk_direction == pytest.approx(direction)
    assert action.walk_speed == pytest.approx(speed)


def test_turns_add_up_and_count_once() -> None:
    controls = Controls()
    controls.receive(given(turn=10.0, look=-4.0))
    controls.receive(given(turn=5.0, look=2.0))

    action = controls.take(yaw=0.0, frames=5)
    assert (action.turn, action.look) == (3.0, -0.4)  # degrees a frame
    assert controls.take(0.0, 5).turn == 0.0


def test_a_body_follows_a_mouse_that_is_faster_than_it() -> None:
    controls = Controls()
    controls.receive(given(turn=20.0, look=-7.21))  # the body turns 7.2° in a frame

    taken = [controls.take(0.0, frames=1, turn_speed=360.0) for _ in range(4)]
    assert [action.turn for action in taken] == [7.2, 7.2, 5.6, 0.0]
    assert [action.look for action in taken] == [-7.2, 0.0, 0.0, 0.0]


def test_what_the_body_has_yet_to_turn_is_told_with_the_inputs_that_turn_it() -> None:
    controls = Controls()
    controls.receive(given(turn=10.0))
    controls.take(0.0, frames=1, turn_speed=360.0)
    controls.receive(given(number=2, turn=5.0))
    assert controls.ahead == (0.0, 0.0)
    controls.confirm()
    assert (controls.taken, controls.ahead) == (1, (2.8, 0.0))


def test_a_mouse_is_a_tenth_of_a_second_ahead_at_most() -> None:
    controls = Controls()
    controls.receive(given(turn=400.0))
    taken = [controls.take(0.0, frames=1, turn_speed=360.0).turn for _ in range(10)]
    assert sum(taken) == pytest.approx(7.2 + 36.0)


def test_a_key_that_was_released_before_the_step_counts_in_it() -> None:
    controls = Controls()
    controls.receive(given(number=1, shoot=True, jump=True))
    controls.receive(given(number=2, jump=True))

    first, second = controls.take(0.0, 1), controls.take(0.0, 1)
    assert (first.shoot, first.jump) == (True, True)
    assert (second.shoot, second.jump) == (False, True)
    assert controls.taken == 0  # nothing tells of these steps yet
    controls.confirm()
    assert controls.taken == 2


def test_whoever_leaves_holds_nothing() -> None:
    controls = Controls()
    controls.receive(given(forward=1.0, turn=9.0, shoot=True))
    controls.release()
    assert controls.take(0.0, 1) == Action()
