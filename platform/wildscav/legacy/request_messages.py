"""What the client is told: the state of a match as a ``Request``, as bytes.

All observations list the same boxes, and nearly the same enemies. So each of those is turned into bytes once,
and boxes again only if they change; a list is the bytes of its items, one after the other.
"""

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

import numpy as np

from wildscav.legacy.commander_pb2 import EnemyInfo, GameState, Observation, Request, SupplyInfo, Vector3
from wildscav.legacy.episode import Episode
from wildscav.legacy.events import Events
from wildscav.wire.varint import encode_varint

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

START = Request(game_state=GameState.START).SerializeToString()
UPDATE, OVER = GameState.UPDATE, GameState.OVER
OBSERVATIONS = bytes([Request.AGENT_OBS_LIST_FIELD_NUMBER << 3 | 2])  # tag of a field of bytes
STEEPEST = 89.99  # degrees: straight up and down, the client's own raycaster does not know where right is
Row = dict[str, list]  # type: ignore[type-arg] # facts of agents by name, one for each seat


class Requests:
    """Makes the requests of one match.

    Args:
        match: The match.
        episode: What the client asked for.
    """

    def __init__(self, match: "Match", episode: Episode) -> None:
        self._match = match
        self._agents = [_Agent(seat, episode.ids) for seat in range(match.seats)]
        self._boxes = _Boxes(match) if match.track.has_supplies else None
        self._events = Events(match, episode) if episode.has_events else None
        self._head = Request()

    def next(self) -> bytes:
        """Return the request for the match as it stands: at first, and after each step."""
        match, head = self._match, self._head
        head.game_state = OVER if match.over else UPDATE
        head.time_step = match.frame
        if self._events is not None:
            head.event_info.CopyFrom(self._events.next())
        facts = _facts(match)
        boxes = b"" if self._boxes is None else self._boxes.as_bytes()
        own = [agent.own(facts) for agent in self._agents]
        enemies = [agent.as_enemy(facts) for agent in self._agents] if match.seats > 1 else [b""]
        parts = [head.SerializeToString()]
        for seat, observation in enumerate(own):
            others = b"".join(enemies[:seat] + enemies[seat + 1 :])
            size = len(observation) + len(boxes) + len(others)
            parts += (OBSERVATIONS, encode_varint(size), observation, boxes, others)
        return b"".join(parts)


class _Agent:
    """What is told of one agent. Its messages are made once and written over: making them takes longer."""

    def __init__(self, seat: int, ids: tuple[int, ...]) -> None:
        self._seat, self._ids = seat, ids
        self._own = Observation(id=ids[seat])
        self._list = Observation(enemy_info_list=[EnemyInfo(enemy_id=ids[seat])])
        self._enemy = self._list.enemy_info_list[0]

    def own(self, facts: Row) -> bytes:
        """Return what the agent is told of itself."""
        seat, own = self._seat, self._own
        _write_motion(own, facts, seat)
        own.pitch = min(STEEPEST, max(-STEEPEST, facts["pitch"][seat]))
        own.yaw = facts["yaw"][seat]
        own.hp = health = facts["health"][seat]
        own.num_gun_ammo, own.num_pack_ammo = facts["clip"][seat], facts["spare_ammo"][seat]
        own.on_ground, own.is_fire = facts["on_ground"][seat], facts["fired"][seat]
        own.is_reload = facts["reload_left"][seat] > 0
        own.can_pickup, own.num_supply = facts["can_pick_up"][seat], facts["supplies"][seat]
        own.is_waiting_respawn = health <= 0
        own.is_invincible = facts["invincible_left"][seat] > 0
        self._write_hits(facts["hit_seat"][seat], facts["hit_by_seat"][seat])
        return own.SerializeToString()

    def _write_hits(self, hit: int, hit_by: int) -> None:
        """Write whom it hit and who hit it, seats or -1; ids of nobody are not sent."""
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

    def as_enemy(self, facts: Row) -> bytes:
        """Return what the others are told of the agent, as a list of one enemy."""
        seat, enemy = self._seat, self._enemy
        _write_motion(enemy, facts, seat)
        enemy.hp = health = facts["health"][seat]
        enemy.is_respawn = health <= 0
        enemy.is_invincible = facts["invincible_left"][seat] > 0
        return self._list.SerializeToString()


def _write_motion(message: Observation | EnemyInfo, facts: Row, seat: int) -> None:
    """Write where an agent is, and which way and how fast it moves; no way for one who stands."""
    place, way = message.location, message.move_dir
    place.x, place.y, place.z = facts["position"][seat]
    x, y, z = facts["velocity"][seat]
    message.move_speed = speed = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / speed if speed > 0.0 else 0.0
    way.x, way.y, way.z = x * scale, y * scale, z * scale


def _facts(match: "Match") -> Row:
    """Return a match's state as plain lists; each array is converted once, not element by element."""
    agents = match.state.agents
    facts: Row = {name: getattr(agents, name)[0].tolist() for name in _FACTS}
    has_boxes = match.track.has_supplies
    facts["can_pick_up"] = match.seen.can_pick_up[0].tolist() if has_boxes else [False] * match.seats
    return facts


_FACTS = (
    *("position", "velocity", "yaw", "pitch", "on_ground", "health", "clip", "spare_ammo", "reload_left"),
    *("fired", "hit_seat", "hit_by_seat", "invincible_left", "supplies"),
)


class _Boxes:
    """The supply boxes as bytes, of a list of ``supply_info_list``; made anew where a box has changed.

    Args:
        match: At its start.
    """

    def __init__(self, match: "Match") -> None:
        self._match = match
        # Boxes that lie there at some time from now on, those dropped at deaths aside.
        self._waves = sorted(set(match.state.supplies.appears[0].tolist()))
        self._key: tuple[bytes, bytes, int] | None = None
        self._bytes = b""
        self._box_bytes: dict[tuple[int, int], bytes] = {}  # by serial number and quantity

    def as_bytes(self) -> bytes:
        """Return the boxes that lie there now."""
        supplies, frame = self._match.state.supplies, self._match.frame
        key = (supplies.quantity.tobytes(), supplies.serial.tobytes(), bisect_right(self._waves, frame))
        if key != self._key:
            self._key = key
            slots = np.nonzero((supplies.quantity[0] > 0) & (supplies.appears[0] <= frame))[0]
            facts = (array[0][slots].tolist() for array in (supplies.serial, supplies.quantity))
            places = supplies.position[0][slots].tolist()
            self._bytes = b"".join(self._box(*box) for box in zip(*facts, places, strict=True))
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
