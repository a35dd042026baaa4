"""Encoding of a match's state as the bytes of a ``Request`` to the client.

All observations list the same boxes, and nearly the same enemies. So each of those is serialized once, and
boxes again only if they change; a list is the concatenation of its items' bytes.
"""

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

import numpy as np

from wildscav.wire.observations import encode_varint
from wildscav_legacy.commander_pb2 import EnemyInfo, GameState, Observation, Request, SupplyInfo, Vector3
from wildscav_legacy.episode import Episode
from wildscav_legacy.events import Events

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

START = Request(game_state=GameState.START).SerializeToString()
UPDATE, OVER = GameState.UPDATE, GameState.OVER
OBSERVATIONS = bytes([Request.AGENT_OBS_LIST_FIELD_NUMBER << 3 | 2])  # tag of a field of bytes
STEEPEST = 89.99  # degrees; at 90 the "right" direction of the client's raycaster is undefined
Columns = dict[str, list]  # type: ignore[type-arg] # fields of agents by name, with a value for each seat


class Requests:
    """Makes the requests of one match."""

    def __init__(self, match: "Match", episode: Episode) -> None:
        self._match = match
        self._agents = [_Agent(seat, episode.ids) for seat in range(match.seats)]
        self._boxes = _Boxes(match) if match.track.has_supplies else None
        self._events = Events(match, episode) if episode.has_events else None
        self._head = Request()

    def next(self) -> bytes:
        """Return the request for the match's current state; call it at the start and after each step."""
        match, head = self._match, self._head
        head.game_state = OVER if match.over else UPDATE
        head.time_step = match.frame
        if self._events is not None:
            head.event_info.CopyFrom(self._events.next())
        columns = _columns(match)
        boxes = b"" if self._boxes is None else self._boxes.as_bytes()
        own = [agent.own(columns) for agent in self._agents]
        enemies = [agent.as_enemy(columns) for agent in self._agents] if match.seats > 1 else [b""]
        parts = [head.SerializeToString()]
        for seat, observation in enumerate(own):
            others = b"".join(enemies[:seat] + enemies[seat + 1 :])
            size = len(observation) + len(boxes) + len(others)
            parts += (OBSERVATIONS, encode_varint(size), observation, boxes, others)
        return b"".join(parts)


class _Agent:
    """The messages about one agent. They are created once and overwritten, which is faster."""

    def __init__(self, seat: int, ids: tuple[int, ...]) -> None:
        self._seat, self._ids = seat, ids
        self._own = Observation(id=ids[seat])
        self._list = Observation(enemy_info_list=[EnemyInfo(enemy_id=ids[seat])])
        self._enemy = self._list.enemy_info_list[0]

    def own(self, columns: Columns) -> bytes:
        """Return the agent's own state."""
        seat, own = self._seat, self._own
        _write_motion(own, columns, seat)
        own.pitch = min(STEEPEST, max(-STEEPEST, columns["pitch"][seat]))
        own.yaw = columns["yaw"][seat]
        own.hp = health = columns["health"][seat]
        own.num_gun_ammo, own.num_pack_ammo = columns["clip"][seat], columns["spare_ammo"][seat]
        own.on_ground, own.is_fire = columns["on_ground"][seat], columns["fired"][seat]
        own.is_reload = columns["reload_left"][seat] > 0
        own.can_pickup, own.num_supply = columns["can_pick_up"][seat], columns["supplies"][seat]
        own.is_waiting_respawn = health <= 0
        own.is_invincible = columns["invincible_left"][seat] > 0
        self._write_hits(columns["hit_seat"][seat], columns["hit_by_seat"][seat])
        return own.SerializeToString()

    def _write_hits(self, hit: int, hit_by: int) -> None:
        """Write the seats that it hit and was hit by, or -1 for none, in which case no id is sent."""
        own = self._own
        own.hit_enemy, own.hit_by_enemy = hit >= 0, hit_by >= 0
        if hit >= 0:
            own.hit_enemy_id = self._ids[hit]
        else:
            own.ClearField("hit_enemy_id")
        if hit_by >= 0:
            own.hit_by_enemy_id = self._ids[hit_by]
        else:
            own.ClearField("hit_by_enemy_id")

    def as_enemy(self, columns: Columns) -> bytes:
        """Return the agent as other agents see it, as a list of one enemy."""
        seat, enemy = self._seat, self._enemy
        _write_motion(enemy, columns, seat)
        enemy.hp = health = columns["health"][seat]
        enemy.is_respawn = health <= 0
        enemy.is_invincible = columns["invincible_left"][seat] > 0
        return self._list.SerializeToString()


def _write_motion(message: Observation | EnemyInfo, columns: Columns, seat: int) -> None:
    """Write an agent's location, direction and speed; the direction of one that stands is zero."""
    place, direction = message.location, message.move_dir
    place.x, place.y, place.z = columns["position"][seat]
    x, y, z = columns["velocity"][seat]
    message.move_speed = speed = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / speed if speed > 0.0 else 0.0
    direction.x, direction.y, direction.z = x * scale, y * scale, z * scale


def _columns(match: "Match") -> Columns:
    """Return a match's state as plain lists; each array is converted as a whole, which is faster."""
    agents = match.state.agents
    columns: Columns = {name: getattr(agents, name)[0].tolist() for name in _FIELDS}
    has_boxes = match.track.has_supplies
    columns["can_pick_up"] = match.seen.can_pick_up[0].tolist() if has_boxes else [False] * match.seats
    return columns


_FIELDS = (
    *("position", "velocity", "yaw", "pitch", "on_ground", "health", "clip", "spare_ammo", "reload_left"),
    *("fired", "hit_seat", "hit_by_seat", "invincible_left", "supplies"),
)


class _Boxes:
    """The supply boxes as the bytes of a ``supply_info_list``, serialized again when a box has changed.

    The match must be at its start.
    """

    def __init__(self, match: "Match") -> None:
        self._match = match
        # The frames in which boxes appear, except for those dropped at deaths.
        self._waves = sorted(set(match.state.supplies.appears[0].tolist()))
        self._key: tuple[bytes, bytes, int] | None = None
        self._bytes = b""
        self._box_bytes: dict[tuple[int, int], bytes] = {}  # by serial number and quantity

    def as_bytes(self) -> bytes:
        """Return the boxes that are on the map now."""
        supplies, frame = self._match.state.supplies, self._match.frame
        key = (supplies.quantity.tobytes(), supplies.serial.tobytes(), bisect_right(self._waves, frame))
        if key != self._key:
            self._key = key
            slots = np.nonzero((supplies.quantity[0] > 0) & (supplies.appears[0] <= frame))[0]
            serials, quantities = supplies.serial[0][slots].tolist(), supplies.quantity[0][slots].tolist()
            places = supplies.position[0][slots].tolist()
            self._bytes = b"".join(map(self._box, serials, quantities, places))
        return self._bytes

    def _box(self, serial: int, quantity: int, place: list[float]) -> bytes:
        known = self._box_bytes.get((serial, quantity))
        if known is None:
            x, y, z = place
            location = Vector3(x=x, y=y, z=z)
            box = SupplyInfo(supply_id=serial, supply_location=location, supply_quantity=quantity)
            known = Observation(supply_info_list=[box]).SerializeToString()
            self._box_bytes[serial, quantity] = known
        return known
