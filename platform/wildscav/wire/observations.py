"""Observations: from plain lists of a match's state into messages, and from messages into SDK classes."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav.proto.match_pb2 import Observation as ObservationMessage
from wildscav.proto.match_pb2 import ServerMessage, Tensor
from wildscav.proto.match_pb2 import SupplyBox as SupplyBoxMessage
from wildscav.proto.match_pb2 import Vector as VectorMessage
from wildscav.proto.match_pb2 import VisibleAgent as VisibleAgentMessage
from wildscav.sdk.agent import Observation, SupplyBox, Vector, VisibleAgent

Vectors = list[list[float]]  # one [x, y, z] an entry


class Snapshot(NamedTuple):
    """All that any seat may sense of a match at one moment; each list has one entry a seat."""

    step: int
    frame: int
    position: Vectors  # m
    velocity: Vectors  # m/s
    team: list[int]
    yaw: list[float]  # degrees
    pitch: list[float]  # degrees
    on_ground: list[bool]
    in_water: list[bool]
    health: list[int]  # hp
    clip: list[int]
    spare_ammo: list[int]
    reload_left: list[int]  # frames
    fired: list[bool]
    hit_seat: list[int]  # -1 for nobody
    hit_by_seat: list[int]  # -1 for nobody
    invincible_left: list[int]  # frames
    respawn_left: list[int]  # frames
    supplies: list[int]
    gained: list[int]
    can_pick_up: list[bool]
    target: list[list[float] | None]  # m, None as long as the seat does not know it
    # What a seat sees, nearest first; what lies past the count means nothing.
    agent_count: list[int]
    agents: list[list[int]]  # their seats
    box_count: list[int]
    box_serial: list[list[int]]
    box_position: list[Vectors]  # m
    box_quantity: list[list[int]]


def encode_observation(
    at: Snapshot,
    seat: int,
    *,
    seconds_per_frame: float,
    time_bank: float,
    tensors: Mapping[str, NDArray[Any]],
) -> ServerMessage:
    """Return what one seat senses, as a message.

    Args:
        at: The moment.
        seat: Whose senses.
        seconds_per_frame: Length of a frame, s.
        time_bank: What is left of the seat's bank, s.
        tensors: The seat's sensor readings by name, C-contiguous.
    """
    message = ServerMessage()
    observation = message.observation
    observation.step = at.step
    observation.frame = at.frame
    observation.time_bank = time_bank
    _fill_vector(observation.position, at.position[seat])
    _fill_vector(observation.velocity, at.velocity[seat])
    _fill_self(observation, at, seat, seconds_per_frame)
    _fill_seen(observation, at, seat)
    for name, array in tensors.items():
        observation.tensors.append(encode_tensor(name, array))
    return message


def _fill_vector(message: VectorMessage, value: list[float]) -> None:
    message.x, message.y, message.z = value


def _fill_self(observation: ObservationMessage, at: Snapshot, seat: int, seconds_per_frame: float) -> None:
    observation.yaw = at.yaw[seat]
    observation.pitch = at.pitch[seat]
    observation.on_ground = at.on_ground[seat]
    observation.in_water = at.in_water[seat]
    observation.health = max(0, at.health[seat])
    observation.clip = at.clip[seat]
    observation.spare_ammo = at.spare_ammo[seat]
    observation.reloading = at.reload_left[seat] > 0
    observation.fired = at.fired[seat]
    if at.hit_seat[seat] >= 0:
        observation.hit_seat = at.hit_seat[seat]
    if at.hit_by_seat[seat] >= 0:
        observation.hit_by_seat = at.hit_by_seat[seat]
    observation.invincible = at.invincible_left[seat] > 0
    observation.respawn_in = at.respawn_left[seat] * seconds_per_frame
    observation.can_pick_up = at.can_pick_up[seat]
    observation.supplies = at.supplies[seat]
    observation.gained = at.gained[seat]
    target = at.target[seat]
    if target is not None:
        _fill_vector(observation.target, target)


def _fill_seen(observation: ObservationMessage, at: Snapshot, seat: int) -> None:
    for other in at.agents[seat][: at.agent_count[seat]]:
        agent = observation.agents.add()
        agent.seat = other
        agent.team = at.team[other]
        _fill_vector(agent.position, at.position[other])
        _fill_vector(agent.velocity, at.velocity[other])
        agent.yaw = at.yaw[other]
        agent.health = max(0, at.health[other])
        agent.invincible = at.invincible_left[other] > 0
    for place in range(at.box_count[seat]):
        box = observation.supply_boxes.add()
        box.id = at.box_serial[seat][place]
        _fill_vector(box.position, at.box_position[seat][place])
        box.quantity = at.box_quantity[seat][place]


def encode_tensor(name: str, array: NDArray[Any]) -> Tensor:
    """Return an array as raw bytes with its type and shape, byte order little-endian."""
    dtype = array.dtype.newbyteorder("<")
    return Tensor(
        name=name, dtype=dtype.str, shape=array.shape, data=array.astype(dtype, copy=False).tobytes()
    )


def decode_observation(message: ObservationMessage, frames_per_second: int) -> Observation:
    """Return an observation as the SDK shows it.

    Raises:
        ValueError: A tensor's type, shape and data do not fit together.
    """
    health, target = message.health, message.target if message.HasField("target") else None
    return Observation(
        step=message.step,
        frame=message.frame,
        time=message.frame / frames_per_second,
        time_bank=message.time_bank,
        position=decode_vector(message.position),
        velocity=decode_vector(message.velocity),
        yaw=message.yaw,
        pitch=message.pitch,
        on_ground=message.on_ground,
        in_water=message.in_water,
        alive=health > 0,
        health=health,
        clip=message.clip,
        spare_ammo=message.spare_ammo,
        reloading=message.reloading,
        fired=message.fired,
        hit_seat=message.hit_seat if message.HasField("hit_seat") else None,
        hit_by_seat=message.hit_by_seat if message.HasField("hit_by_seat") else None,
        invincible=message.invincible,
        respawn_in=message.respawn_in,
        can_pick_up=message.can_pick_up,
        supplies=message.supplies,
        gained=message.gained,
        target=None if target is None else decode_vector(target),
        agents=tuple(map(_decode_agent, message.agents)),
        supply_boxes=tuple(map(_decode_box, message.supply_boxes)),
        tensors={tensor.name: decode_tensor(tensor) for tensor in message.tensors},
    )


def decode_vector(message: VectorMessage) -> Vector:
    """Return a vector as a tuple (x, y, z)."""
    return (message.x, message.y, message.z)


# Positional arguments in the next two: there can be 48 of them in an observation, ten times a second.


def _decode_agent(message: VisibleAgentMessage) -> VisibleAgent:
    position, velocity = decode_vector(message.position), decode_vector(message.velocity)
    yaw, health = message.yaw, message.health
    return VisibleAgent(message.seat, message.team, position, velocity, yaw, health, message.invincible)


def _decode_box(message: SupplyBoxMessage) -> SupplyBox:
    return SupplyBox(message.id, decode_vector(message.position), message.quantity)


def decode_tensor(message: Tensor) -> NDArray[Any]:
    """Return a tensor as a read-only array over the message's own bytes.

    Raises:
        ValueError: Type, shape and data do not fit together.
    """
    shape = tuple(message.shape)
    try:
        dtype = np.dtype(message.dtype)
    except TypeError:
        raise ValueError(f"tensor {message.name!r} has the unknown type {message.dtype!r}") from None
    if dtype.hasobject or math.prod(shape) * dtype.itemsize != len(message.data):
        raise ValueError(
            f"tensor {message.name!r} says {message.dtype} {shape} but holds {len(message.data)} bytes"
        )
    return np.frombuffer(message.data, dtype).reshape(shape)
