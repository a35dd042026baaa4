"""What the client is told: the state of a match as a ``Request``, as bytes.

All observations list the same boxes, and nearly the same enemies. So each of those is turned into bytes once,
and boxes again only if they change; a list is the bytes of its items, one after the other.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav.legacy.commander_pb2 import (
    EnemyInfo,
    GameState,
    Observation,
    Request,
    SupplyInfo,
    Vector3,
)
from wildscav.legacy.episode import Episode
from wildscav.legacy.events import Events

if TYPE_CHECKING:
    from wildscav_engine.match import Match

START = Request(game_state=GameState.START).SerializeToString()
STANDING = Vector3(x=0.0, y=0.0, z=0.0)
OBSERVATIONS = bytes([Request.AGENT_OBS_LIST_FIELD_NUMBER << 3 | 2])  # tag of a field of bytes


class Requests:
    """Makes the requests of one match.

    Args:
        match: The match.
        episode: What the client asked for.
    """

    def __init__(self, match: "Match", episode: Episode) -> None:
        self._match, self._ids = match, episode.ids
        self._boxes = _Boxes()
        self._events = Events(match, episode) if episode.has_events else None

    def next(self) -> bytes:
        """Return the request for the match as it stands: at first, and after each step."""
        match = self._match
        events = None if self._events is None else self._events.next()
        state = GameState.OVER if match.over else GameState.UPDATE
        head = Request(game_state=state, time_step=match.frame, event_info=events)
        parts = [head.SerializeToString()]
        boxes = self._boxes.as_bytes(match)
        facts = _facts(match)
        enemies = [self._enemy(facts, seat) for seat in range(match.seats)] if match.seats > 1 else [b""]
        for seat in range(match.seats):
            own = self._own(facts, seat).SerializeToString()
            others = b"".join(enemies[:seat] + enemies[seat + 1 :])
            size = len(own) + len(boxes) + len(others)
            parts += (OBSERVATIONS, _varint(size), own, boxes, others)
        return b"".join(parts)

    def _own(self, facts: "_Facts", seat: int) -> Observation:
        """Return what an agent is told of itself."""
        x, y, z = facts["position"][seat]
        direction, speed = _motion(facts["velocity"][seat])
        hit, hit_by = facts["hit_seat"][seat], facts["hit_by_seat"][seat]
        observation = Observation(
            id=self._ids[seat],
            location=Vector3(x=x, y=y, z=z),
            pitch=facts["pitch"][seat],
            yaw=facts["yaw"][seat],
            hp=facts["health"][seat],
            move_dir=direction,
            move_speed=speed,
            num_gun_ammo=facts["clip"][seat],
            num_pack_ammo=facts["spare_ammo"][seat],
            on_ground=facts["on_ground"][seat],
            is_fire=facts["fired"][seat],
            is_reload=facts["reload_left"][seat] > 0,
            hit_enemy=hit >= 0,
            hit_by_enemy=hit_by >= 0,
            can_pickup=facts["can_pick_up"][seat],
            num_supply=facts["supplies"][seat],
            is_waiting_respawn=facts["health"][seat] <= 0,
            is_invincible=facts["invincible_left"][seat] > 0,
        )
        if hit >= 0:
            observation.hit_enemy_id = self._ids[hit]
        if hit_by >= 0:
            observation.hit_by_enemy_id = self._ids[hit_by]
        return observation

    def _enemy(self, facts: "_Facts", seat: int) -> bytes:
        """Return what the others are told of an agent, as a list of one enemy."""
        x, y, z = facts["position"][seat]
        direction, speed = _motion(facts["velocity"][seat])
        enemy = EnemyInfo(
            location=Vector3(x=x, y=y, z=z),
            move_dir=direction,
            move_speed=speed,
            hp=facts["health"][seat],
            enemy_id=self._ids[seat],
            is_respawn=facts["health"][seat] <= 0,
            is_invincible=facts["invincible_left"][seat] > 0,
        )
        return Observation(enemy_info_list=[enemy]).SerializeToString()


_Facts = dict[str, list]  # type: ignore[type-arg] # of each seat


def _facts(match: "Match") -> _Facts:
    """Return a match's state as plain lists; each array is converted once, not element by element."""
    agents = match.state.agents
    facts: _Facts = {name: getattr(agents, name)[0].tolist() for name in _OWN}
    if match.track.has_supplies:
        facts["can_pick_up"] = match.seen.can_pick_up[0].tolist()
    else:
        facts["can_pick_up"] = [False] * match.seats
    return facts


_OWN = (
    *("position", "velocity", "yaw", "pitch", "on_ground", "health", "clip", "spare_ammo", "reload_left"),
    *("fired", "hit_seat", "hit_by_seat", "invincible_left", "supplies"),
)


def _motion(velocity: list[float]) -> tuple[Vector3, float]:
    """Return the direction of a velocity in m/s, and its size; no direction for one who stands."""
    x, y, z = velocity
    speed = math.sqrt(x * x + y * y + z * z)
    return (Vector3(x=x / speed, y=y / speed, z=z / speed), speed) if speed > 0.0 else (STANDING, 0.0)


class _Boxes:
    """The supply boxes as bytes, of a list of ``supply_info_list``; made anew where a box has changed."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[tuple[int, int], bytes]] = {}  # by slot: what it was made from
        self._there: NDArray[np.int64] = np.zeros((0, 3), np.int64)
        self._bytes = b""

    def as_bytes(self, match: "Match") -> bytes:
        """Return the boxes that lie there now."""
        supplies = match.state.supplies
        quantity, serial = supplies.quantity[0], supplies.serial[0]
        slots = np.nonzero((quantity > 0) & (supplies.appears[0] <= match.frame))[0]
        there = np.stack([slots, serial[slots], quantity[slots]], axis=1)
        if not np.array_equal(there, self._there):
            places = supplies.position[0][slots].tolist()
            boxes = zip(there.tolist(), places, strict=True)
            self._there = there
            self._bytes = b"".join(self._box(slot, key, place) for (slot, *key), place in boxes)
        return self._bytes

    def _box(self, slot: int, key: list[int], place: list[float]) -> bytes:
        known = self._known.get(slot)
        if known is None or known[0] != tuple(key):
            (serial, quantity), (x, y, z) = key, place
            location = Vector3(x=x, y=y, z=z)
            box = SupplyInfo(supply_id=serial, supply_location=location, supply_quantity=quantity)
            known = (serial, quantity), Observation(supply_info_list=[box]).SerializeToString()
            self._known[slot] = known
        return known[1]


def _varint(number: int) -> bytes:
    """Return a whole number as the wire format has it: seven bits a byte, the lowest first."""
    parts = bytearray()
    while number > 127:
        parts.append(number & 127 | 128)
        number >>= 7
    parts.append(number)
    return bytes(parts)
