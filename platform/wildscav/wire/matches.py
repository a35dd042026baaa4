"""Messages that are sent once per match: joining, the match info, results."""

from collections.abc import Mapping
from typing import Any

from wildscav.agent import MatchInfo, SupplyWave, Vector
from wildscav.proto import PROTOCOL_VERSION
from wildscav.proto.match_pb2 import (
    ClientMessage,
    HostMatchResponse,
    Join,
    SeatResult,
    ServerMessage,
)
from wildscav.proto.match_pb2 import MatchInfo as MatchInfoMessage
from wildscav.proto.match_pb2 import SupplyWave as SupplyWaveMessage
from wildscav.proto.match_pb2 import Vector as VectorMessage
from wildscav.wire.observations import decode_vector

SDK_LIMIT = 100  # characters of a client's name, and of its version


def encode_join(token: str, sdk_name: str, sdk_version: str) -> ClientMessage:
    """Return the message that takes a seat."""
    join = Join(
        token=token,
        protocol_version=PROTOCOL_VERSION,
        sdk_name=sdk_name,
        sdk_version=sdk_version,
        gets_ready=True,
    )
    return ClientMessage(join=join)


def decode_sdk(join: Join) -> str:
    """Return the client's name and version in a line that is safe to print."""
    parts = (part[:SDK_LIMIT] for part in (join.sdk_name, join.sdk_version))
    return " ".join("".join(one if one.isprintable() else "?" for one in part) for part in parts).strip()


def encode_match_info(info: MatchInfo) -> ServerMessage:
    """Return the message that describes the match to a seat."""
    message = MatchInfoMessage(
        protocol_version=PROTOCOL_VERSION,
        start=_vector(info.start),
        target=None if info.target is None else _vector(info.target),
        supply_waves=[
            SupplyWaveMessage(
                time=wave.time, center_x=wave.center[0], center_z=wave.center[1], radius=wave.radius
            )
            for wave in info.supply_waves
        ],
        **{name: getattr(info, name) for name in _SAME},
    )
    return ServerMessage(match_info=message)


# Fields with the same name and meaning in the message and in the SDK.
_SAME = (
    *("track", "seat", "seats", "team", "time_limit", "frames_per_action", "frames_per_second", "map_size"),
    *("seed", "step_budget", "time_bank", "target_distance", "pick_up_distance", "supply_sight"),
    *("respawns", "supply_goal"),
    *("clip_size", "start_health"),
    *("senses", "turn_speed", "spread", "recoil", "walking_sway", "turning_sway", "bounty", "clock"),
    *("token_time", "processor_time"),
)
# What holds on a server that is too old to say so.
_UNTOLD = {name: MatchInfo.__dataclass_fields__[name].default for name in ("senses", "turn_speed", "clock")}


def _vector(value: Vector) -> VectorMessage:
    return VectorMessage(x=value[0], y=value[1], z=value[2])


def decode_match_info(message: MatchInfoMessage) -> MatchInfo:
    """Return the match info as the SDK shows it."""
    same: dict[str, Any] = {name: getattr(message, name) for name in _SAME}
    return MatchInfo(
        start=decode_vector(message.start),
        target=decode_vector(message.target) if message.HasField("target") else None,
        supply_waves=tuple(
            SupplyWave(wave.time, (wave.center_x, wave.center_z), wave.radius)
            for wave in message.supply_waves
        ),
        **same | {name: value for name, value in _UNTOLD.items() if not same[name]},
    )


def encode_seat_result(values: Mapping[str, Any], name: str) -> SeatResult:
    """Return a seat's result: the fields of the engine's ``SeatResult``, and its display name."""
    return SeatResult(name=name, **values)


def encode_seat_address(address: str) -> str:
    """Return the address of a worker's seats in the form that is sent: for a port, only its number.

    The client knows better than the server under which name it reaches the host.
    """
    return address if address.startswith("unix:") else f":{address.rpartition(':')[2]}"


def decode_seat_address(hosted: HostMatchResponse, called: str) -> str:
    """Return where a hosted match's seats are joined by a client that has called an address."""
    address = hosted.seat_address
    if address.startswith(":"):
        return called.rpartition(":")[0] + address
    return address or called
