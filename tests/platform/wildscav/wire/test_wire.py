"""What goes into a message comes out of it."""

import gc
import math
from itertools import product
from types import FrameType
from typing import Any

import hypothesis.extra.numpy as arrays
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.platform.wildscav.skills.observations import match_info

from wildscav import Action, Observation, SupplyWave
from wildscav.agent import ACTION_FIELDS
from wildscav.errors import AgentError
from wildscav.proto.match_pb2 import Observation as ObservationMessage
from wildscav.proto.match_pb2 import ServerMessage, SupplyBox, Tensor, Vector, VisibleAgent
from wildscav.wire.actions import decode_action, encode_action
from wildscav.wire.matches import decode_match_info, encode_match_info
from wildscav.wire.observations import (
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


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *product(("walk_direction", "walk_speed", "turn", "look"), (math.nan, math.inf, -math.inf, 1e39)),
        *(("walk_speed", 10.01), ("walk_speed", -0.01)),
    ],
)
def test_a_number_out_of_range_or_not_finite_in_32_bits_makes_no_action(name: str, value: float) -> None:
    message = encode_action(0, Action(**{name: value})).action
    assert decode_action(message, outside=()).row is None


def test_fields_outside_the_action_set_are_ignored_and_counted() -> None:
    message = encode_action(0, Action(walk_speed=4.0, shoot=True, reload=True)).action
    row, ignored = decode_action(message, outside=(5, 6, 7))
    assert row == [0.0, 4.0, *[0.0] * (len(ACTION_FIELDS) - 2)]
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
        (Tensor(name="x", dtype="<f4", shape=[2, 2], data=b"\0" * 15), "has 15 bytes"),
        (Tensor(name="x", dtype="pickle", shape=[1], data=b"\0"), "unknown type"),
        (Tensor(name="x", dtype="O", shape=[1], data=b"\0" * 8), "has 8 bytes"),
    ],
)
def test_a_tensor_that_contradicts_itself_is_refused(tensor: Tensor, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        decode_tensor(tensor)


def test_a_match_info_arrives() -> None:
    waves = SupplyWave(0.0, (20.0, -20.0), 30.0), SupplyWave(60.0, (1.0, 2.0), 50.0)
    place = {"seat": 2, "seats": 10, "team": 3, "start": (1.5, -2.25, 3.125)}
    info = match_info(**place, supply_waves=waves, seed=2**63 - 1, clock="paused")
    assert decode_match_info(encode_match_info(info).match_info) == info
    assert info.step_time == 0.1


PLACE = Vector(x=4.0, y=5.0, z=6.0)
SENSED = ObservationMessage(
    step=4,
    frame=20,
    time_bank=29.5,
    position=Vector(x=1.0, y=2.0, z=3.0),
    velocity=Vector(x=0.5, z=-0.5),
    yaw=-90.0,
    pitch=10.0,
    on_ground=True,
    health=80,
    clip=15,
    spare_ammo=60,
    fired=True,
    hit_seat=1,
    can_pick_up=True,
    supplies=12,
    gained=5,
    team_supplies=30,
    reload_in=1.5,
    invincible_in=0.5,
    agents=[
        VisibleAgent(
            seat=1,
            team=1,
            position=PLACE,
            velocity=Vector(),
            yaw=45.0,
            health=100,
            invincible=True,
        )
    ],
    supply_boxes=[SupplyBox(id=77, position=Vector(x=7.0, y=8.0, z=9.0), quantity=40)],
)


def arriving(message: ObservationMessage, **tensors: NDArray[Any]) -> Observation:
    """Return an observation that was sent and received."""
    sent = ServerMessage.FromString(encode_observation(message.SerializeToString(), tensors))
    return decode_observation(sent.observation, frames_per_second=50)


def test_an_observation_arrives() -> None:
    seen = arriving(SENSED, depth=np.ones((2, 3)))
    assert (seen.step, seen.frame, seen.time, seen.time_bank) == (4, 20, 0.4, 29.5)
    assert (seen.position, seen.velocity, seen.yaw, seen.pitch) == ((1, 2, 3), (0.5, 0, -0.5), -90, 10)
    assert (seen.on_ground, seen.in_water, seen.alive, seen.health) == (True, False, True, 80)
    assert (seen.clip, seen.spare_ammo, seen.reloading, seen.fired) == (15, 60, False, True)
    assert (seen.hit_seat, seen.hit_by_seat, seen.invincible, seen.respawn_in) == (1, None, False, 0)
    assert (seen.can_pick_up, seen.supplies, seen.gained) == (True, 12, 5)
    assert (seen.team_supplies, seen.reload_in, seen.invincible_in) == (30, 1.5, 0.5)
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
        arriving(SENSED, depth=np.ones((2, 3))).sensor("lidar")
    assert str(caught.value) == (
        "this agent did not ask for the sensor 'lidar' (it has depth): "
        "add a [sensors.lidar] table to its submission.toml"
    )


def test_what_is_not_in_the_message_is_nothing() -> None:
    seen = arriving(ObservationMessage(hit_by_seat=0, target=Vector(x=1.5, y=2.0, z=-3.0)))
    assert (seen.agents, seen.supply_boxes, seen.tensors, seen.position) == ((), (), {}, (0, 0, 0))
    assert (seen.hit_seat, seen.hit_by_seat, seen.reloading, seen.invincible) == (None, 0, False, False)
    assert seen.target == (1.5, 2.0, -3.0)


def test_the_dead_know_when_they_come_back() -> None:
    seen = arriving(ObservationMessage(health=0, respawn_in=2.5))
    assert (seen.alive, seen.health, seen.respawn_in) == (False, 0, 2.5)


@pytest.mark.parametrize("length", [0, 1, 127, 128, 16_383, 16_384, 300_000])
def test_an_observation_of_any_length_is_framed_as_protobuf_does(length: int) -> None:
    tensor = np.ones(length, np.uint8)
    whole = ObservationMessage(step=4, tensors=[encode_tensor("x", tensor)])
    sent = encode_observation(ObservationMessage(step=4).SerializeToString(), {"x": tensor})
    assert sent == ServerMessage(observation=whole).SerializeToString()


@pytest.mark.parametrize(("tensors", "kept"), [({"depth": np.ones(4)}, False), ({}, True)])
def test_an_observation_that_is_kept_does_not_keep_its_tensors_twice(
    tensors: dict[str, NDArray[Any]], kept: bool
) -> None:
    message = ServerMessage.FromString(encode_observation(SENSED.SerializeToString(), tensors)).observation
    seen, references = decode_observation(message, 50), gc.get_referrers(message)
    assert any(not isinstance(one, FrameType) for one in references) is kept
    assert seen.step == 4
