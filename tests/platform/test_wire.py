"""What goes into a message comes out of it."""

import math
from typing import Any

import hypothesis.extra.numpy as arrays
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray

from wildscav import Action, MatchInfo, SupplyWave
from wildscav.errors import AgentError
from wildscav.proto.match_pb2 import Tensor
from wildscav.wire.actions import ACTION_FIELDS, decode_action, encode_action
from wildscav.wire.matches import decode_match_info, encode_match_info
from wildscav.wire.observations import (
    Snapshot,
    decode_observation,
    decode_tensor,
    encode_observation,
    encode_tensor,
)

SINGLE = some.floats(width=32, allow_nan=False, allow_infinity=False)


@given(direction=SINGLE, speed=some.floats(0, 10, width=32), turn=SINGLE, look=SINGLE, jump=some.booleans())
def test_every_action_that_may_be_played_arrives(
    direction: float, speed: float, turn: float, look: float, jump: bool
) -> None:
    sent = Action(walk_direction=direction, walk_speed=speed, turn=turn, look=look, jump=jump, pick_up=True)

    message = encode_action(3, sent).action
    row, ignored = decode_action(message, outside=())

    assert message.step == 3
    assert ignored == 0
    assert row is not None
    assert row == np.asarray(row, np.float32).tolist()  # nothing is lost in the record's 32 bits
    got = dict(zip(ACTION_FIELDS, row, strict=True))
    assert (got["walk_speed"], got["jump"], got["pick_up"], got["shoot"]) == (speed, jump, 1.0, 0.0)
    for name, angle in (("walk_direction", direction), ("turn", turn)):
        assert abs(got[name]) <= 360.0
        assert got[name] == angle or got[name] == math.fmod(angle, 360.0)
    assert got["look"] == look or (abs(look) > 360.0 and got["look"] == math.copysign(360.0, look))


@pytest.mark.parametrize("name", ["walk_direction", "walk_speed", "turn", "look"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e39])
def test_a_number_that_is_not_finite_in_32_bits_makes_no_action(name: str, value: float) -> None:
    message = encode_action(0, Action(**{name: value})).action
    assert decode_action(message, outside=()).row is None


def test_fields_outside_the_action_set_are_ignored_and_counted() -> None:
    message = encode_action(0, Action(walk_speed=4.0, shoot=True, reload=True)).action
    row, ignored = decode_action(message, outside=(5, 6, 7))
    assert row == [0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert ignored == 2


@given(
    arrays.arrays(
        dtype=arrays.scalar_dtypes().filter(lambda dtype: dtype.kind in "biuf" and dtype.itemsize <= 8),
        shape=arrays.array_shapes(min_dims=0, max_dims=3, min_side=0),
    )
)
def test_every_tensor_arrives(array: NDArray[Any]) -> None:
    got = decode_tensor(encode_tensor("x", array))
    assert got.shape == array.shape
    assert got.dtype == array.dtype.newbyteorder("<")
    np.testing.assert_array_equal(got, array)
    assert not got.flags.writeable


@pytest.mark.parametrize(
    ("tensor", "message"),
    [
        (Tensor(name="x", dtype="<f4", shape=[2, 2], data=b"\0" * 15), "holds 15 bytes"),
        (Tensor(name="x", dtype="pickle", shape=[1], data=b"\0"), "unknown type"),
        (Tensor(name="x", dtype="O", shape=[1], data=b"\0" * 8), "holds 8 bytes"),
    ],
)
def test_a_tensor_that_contradicts_itself_is_refused(tensor: Tensor, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        decode_tensor(tensor)


def test_a_match_info_arrives() -> None:
    info = MatchInfo(
        track="gathering",
        seat=2,
        seats=10,
        team=3,
        time_limit=600.0,
        frames_per_action=5,
        map_size=500.0,
        start=(1.5, -2.25, 3.125),
        target=None,
        supply_waves=(SupplyWave(0.0, (20.0, -20.0), 30.0), SupplyWave(60.0, (1.0, 2.0), 50.0)),
        seed=2**63 - 1,
        step_budget=0.1,
        time_bank=30.0,
        target_distance=1.0,
        pick_up_distance=1.5,
        supply_sight=20.0,
        clip_size=15,
        start_health=100,
    )
    assert decode_match_info(encode_match_info(info).match_info) == info
    assert info.step_time == 0.1


def snapshot(**changes: Any) -> Snapshot:
    """Two seats; the first sees the second and one box."""
    lists: dict[str, list[Any]] = {
        "position": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        "velocity": [[0.5, 0.0, -0.5], [0.0, 0.0, 0.0]],
        "team": [0, 1],
        "yaw": [-90.0, 45.0],
        "pitch": [10.0, 0.0],
        "on_ground": [True, False],
        "in_water": [False, True],
        "health": [80, 100],
        "clip": [15, 3],
        "spare_ammo": [60, 0],
        "reload_left": [0, 7],
        "fired": [True, False],
        "hit_seat": [1, -1],
        "hit_by_seat": [-1, 0],
        "invincible_left": [0, 3],
        "respawn_left": [0, 0],
        "can_pick_up": [True, False],
        "supplies": [12, 0],
        "gained": [5, 0],
        "target": [None, [1.5, 2.0, -3.0]],
        "agent_count": [1, 0],
        "agents": [[1, -1], [-1, -1]],
        "box_count": [1, 0],
        "box_serial": [[77, 0], [0, 0]],
        "box_position": [[[7.0, 8.0, 9.0], [0.0] * 3], [[0.0] * 3] * 2],
        "box_quantity": [[40, 0], [0, 0]],
    }
    return Snapshot(step=4, frame=20, **{**lists, **changes})


def observe(seat: int, **changes: Any) -> Any:
    message = encode_observation(
        snapshot(**changes), seat, seconds_per_frame=0.02, time_bank=29.5, tensors={"depth": np.ones((2, 3))}
    )
    return decode_observation(message.observation, frames_per_second=50)


def test_an_observation_arrives() -> None:
    seen = observe(0)
    assert (seen.step, seen.frame, seen.time, seen.time_bank) == (4, 20, 0.4, 29.5)
    assert (seen.position, seen.velocity, seen.yaw, seen.pitch) == ((1, 2, 3), (0.5, 0, -0.5), -90, 10)
    assert (seen.on_ground, seen.in_water, seen.alive, seen.health) == (True, False, True, 80)
    assert (seen.clip, seen.spare_ammo, seen.reloading, seen.fired) == (15, 60, False, True)
    assert (seen.hit_seat, seen.hit_by_seat, seen.invincible, seen.respawn_in) == (1, None, False, 0)
    assert (seen.can_pick_up, seen.supplies, seen.gained) == (True, 12, 5)
    assert seen.target is None
    (other,) = seen.agents
    assert (other.seat, other.team, other.position, other.health) == (1, 1, (4, 5, 6), 100)
    assert (other.yaw, other.velocity, other.invincible) == (45, (0, 0, 0), True)
    (box,) = seen.supply_boxes
    assert (box.id, box.position, box.quantity) == (77, (7, 8, 9), 40)
    np.testing.assert_array_equal(seen.depth, np.ones((2, 3)))
    assert seen.sensor("depth") is seen.depth


def test_a_sensor_that_was_not_asked_for_is_said_to_be_missing() -> None:
    with pytest.raises(AgentError) as caught:
        observe(0).sensor("lidar")
    assert str(caught.value) == (
        "this agent did not ask for the sensor 'lidar' (it has depth): "
        "add a [sensors.lidar] table to its submission.toml"
    )


def test_the_other_seat_sees_its_own_side_of_it() -> None:
    seen = observe(1)
    assert (seen.agents, seen.supply_boxes) == ((), ())
    assert (seen.hit_seat, seen.hit_by_seat, seen.reloading, seen.invincible) == (None, 0, True, True)
    assert seen.target == (1.5, 2.0, -3.0)


def test_the_dead_know_when_they_come_back() -> None:
    seen = observe(0, health=[0, 100], respawn_left=[125, 0])
    assert (seen.alive, seen.health, seen.respawn_in) == (False, 0, 2.5)
