"""Observations: encoded by the server to the bytes of messages, decoded by the SDK to its classes."""

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Observation, SupplyBox, Vector, VisibleAgent
from wildscav.proto.match_pb2 import Observation as ObservationMessage
from wildscav.proto.match_pb2 import SupplyBox as SupplyBoxMessage
from wildscav.proto.match_pb2 import Tensor
from wildscav.proto.match_pb2 import Vector as VectorMessage
from wildscav.proto.match_pb2 import VisibleAgent as VisibleAgentMessage

KEY = b"\x12"  # of ServerMessage.observation: field 2, length-delimited


def encode_observation(observation: bytes, tensors: Mapping[str, NDArray[Any]]) -> bytes:
    """Return a ``ServerMessage``'s bytes, of an ``Observation`` without tensors and C-contiguous tensors."""
    if tensors:
        readings = [encode_tensor(name, array) for name, array in tensors.items()]
        # The concatenation of two messages is a message with the fields of both.
        observation += ObservationMessage(tensors=readings).SerializeToString()
    return KEY + encode_varint(len(observation)) + observation


def encode_tensor(name: str, array: NDArray[Any]) -> Tensor:
    """Return an array as raw bytes with its type and shape, byte order little-endian."""
    dtype = array.dtype.newbyteorder("<")
    return Tensor(
        name=name, dtype=dtype.str, shape=array.shape, data=array.astype(dtype, copy=False).tobytes()
    )


def decode_observation(message: ObservationMessage, frames_per_second: int) -> Observation:
    """Return an observation as the SDK shows it.

    Its fields are decoded when they are first read. If there are tensors, all fields are decoded at once:
    tensors are large, and the message would keep a second copy of them in memory.

    Raises:
        ValueError: A tensor's type, shape and data do not fit together.
    """
    read = partial(_read_field, message, frames_per_second)
    if message.tensors:
        return Observation(**{field.name: read(field.name) for field in fields(Observation)})
    return Observation.read_by(read)


def _read_field(message: ObservationMessage, frames_per_second: int, name: str) -> Any:
    if name == "time":
        return message.frame / frames_per_second
    read = _READERS.get(name)
    return getattr(message, name) if read is None else read(message)


_READERS: dict[str, Callable[[ObservationMessage], Any]] = {  # of the fields that differ from the message's
    "position": lambda message: decode_vector(message.position),
    "velocity": lambda message: decode_vector(message.velocity),
    "alive": lambda message: message.health > 0,
    "hit_seat": lambda message: message.hit_seat if message.HasField("hit_seat") else None,
    "hit_by_seat": lambda message: message.hit_by_seat if message.HasField("hit_by_seat") else None,
    "target": lambda message: decode_vector(message.target) if message.HasField("target") else None,
    "agents": lambda message: tuple(map(_decode_agent, message.agents)),
    "supply_boxes": lambda message: tuple(map(_decode_box, message.supply_boxes)),
    "tensors": lambda message: {tensor.name: decode_tensor(tensor) for tensor in message.tensors},
}


def decode_vector(message: VectorMessage) -> Vector:
    """Return a vector as a tuple (x, y, z)."""
    return (message.x, message.y, message.z)


# The next two pass positional arguments, which is faster: an observation can have 48 of these items.


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
            f"tensor {message.name!r} says {message.dtype} {shape} but has {len(message.data)} bytes"
        )
    return np.frombuffer(message.data, dtype).reshape(shape)


def encode_varint(number: int) -> bytes:
    """Return a number, at least 0, as protobuf writes it: seven bits per byte, the lowest bits first."""
    parts = bytearray()
    while number > 127:
        parts.append(number & 127 | 128)
        number >>= 7
    parts.append(number)
    return bytes(parts)
