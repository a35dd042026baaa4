"""The training environments' observations, computed from an agent's own observations."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import MatchInfo, Observation, Vector
from wildscav.policy.elementary_functions import cosine, exponential, logarithm, sine
from wildscav.policy.errors import PolicyError

Readings = dict[str, NDArray[Any]]  # by the names of groups and sensors
Values = tuple[float, ...]
NEAR = 5.0  # m, at which the nearness has fallen to 1 / e
COLUMNS = ("known", "east", "up", "north", "right", "ahead", "above the view", "nearness", "log distance")


class Events(NamedTuple):
    """What happened to the agent since the policy's last choice, which may be several steps ago."""

    gained: int = 0  # supplies
    fired: bool = False
    hit: bool = False
    was_hit: bool = False

    def with_step(self, seen: Observation) -> "Events":
        """Return these events and those of one more step."""
        return Events(
            self.gained + seen.gained,
            self.fired or seen.fired,
            self.hit or seen.hit_seat is not None,
            self.was_hit or seen.hit_by_seat is not None,
        )


class Moment(NamedTuple):
    """The inputs from which one observation is computed."""

    match: MatchInfo
    seen: Observation
    events: Events


class Group(NamedTuple):
    """A part of an observation: the names of its numbers, and how they are computed."""

    columns: tuple[str, ...]
    read: Callable[[Moment], Values]


# The groups whose numbers are events, or fields of an ``Observation`` with the same names or with these.
FACT_GROUPS = ("body", "vitals", "weapon")
FACT_NAMES = {"respawn_left": "respawn_in", "invincible_left": "invincible_in", "reload_left": "reload_in"}
_OBSERVED = frozenset(field.name for field in fields(Observation))


def _is_fact(column: str) -> bool:
    return column in Events._fields or FACT_NAMES.get(column, column) in _OBSERVED


def _fact(now: Moment, column: str) -> float:
    if column in Events._fields:
        return float(getattr(now.events, column))
    return float(getattr(now.seen, FACT_NAMES.get(column, column)))


def _view(now: Moment) -> Values:
    yaw, pitch = now.seen.yaw, now.seen.pitch
    angles = (sine(yaw), cosine(yaw), sine(pitch), cosine(pitch))
    return (yaw, pitch, *(max(-1.0, min(1.0, value)) for value in angles))


def _time(now: Moment) -> Values:
    frame, rate = now.seen.frame, now.match.frames_per_second
    limit = max(1, round(now.match.time_limit * rate))
    return max(0, limit - frame) * (1.0 / rate), frame * (1.0 / rate)


def _target(now: Moment) -> Values:
    target = now.seen.target
    if target is None:
        return (0.0,) * 8
    x, y, z = (place - own for place, own in zip(target, now.seen.position, strict=True))
    return (1.0, *target, x, y, z, math.sqrt(x * x + y * y + z * z))


def _supplies(now: Moment) -> Values:
    seen = now.seen
    return seen.supplies, now.events.gained, seen.team_supplies, seen.can_pick_up


def _to_target(now: Moment) -> Values:
    return direction(now.seen, now.seen.target)


def _to_box(now: Moment) -> Values:
    return direction(now.seen, next((box.position for box in now.seen.supply_boxes), None))


def _to_enemy(now: Moment) -> Values:
    enemies = (agent.position for agent in now.seen.agents if agent.team != now.match.team)
    return direction(now.seen, next(enemies, None))


# With the engine's names of columns. Tests check that the numbers equal those of the environments.
GROUPS: dict[str, Group] = {
    "position": Group(("x", "y", "z"), lambda now: now.seen.position),
    "velocity": Group(("x", "y", "z"), lambda now: now.seen.velocity),
    "view": Group(
        ("yaw", "pitch", "sine of yaw", "cosine of yaw", "sine of pitch", "cosine of pitch"), _view
    ),
    "time": Group(("left", "passed"), _time),
    "target": Group(
        ("known", "x", "y", "z", "x from here", "y from here", "z from here", "distance"), _target
    ),
    "supplies": Group(("carried", "picked up in the step", "carried by the team", "can_pick_up"), _supplies),
    "to_target": Group(COLUMNS, _to_target),
    "to_box": Group(COLUMNS, _to_box),
    "to_enemy": Group(COLUMNS, _to_enemy),
}


class Observer:
    """Makes an environment's observations: the parts, in order, in ``observations`` of a description.

    Raises:
        PolicyError: A part is unknown.
    """

    def __init__(self, parts: Sequence[Mapping[str, Any]], *, flat: bool) -> None:
        self._parts = [(str(part["name"]), _columns_of(part)) for part in parts]
        self._flat = flat
        self.shapes = {str(part["name"]): tuple(part["shape"]) for part in parts}
        self.dtypes = {str(part["name"]): np.dtype(part["dtype"]) for part in parts}
        self.options = {str(part["name"]): dict(part["sensor"]) for part in parts if "sensor" in part}
        scales = [np.broadcast_to(np.asarray(part["scale"], np.float64), part["shape"]) for part in parts]
        self._factors = (1.0 / np.concatenate([scale.reshape(-1) for scale in scales])).astype(np.float32)

    @property
    def width(self) -> int:
        """How many numbers an observation has."""
        return len(self._factors)

    def observe(self, match: MatchInfo, seen: Observation, events: Events) -> Readings | NDArray[np.float32]:
        """Return an observation: arrays by name, or (n,) float32 if the environment is flat.

        Raises:
            PolicyError: A sensor's reading is missing, or not as in training.
        """
        now = Moment(match, seen, events)
        readings = {
            name: self._sensor(name, seen) if columns is None else _values(name, columns, now)
            for name, columns in self._parts
        }
        if not self._flat:
            return readings
        row = np.concatenate([values.reshape(-1) for values in readings.values()], dtype=np.float32)
        row *= self._factors
        return row

    def _sensor(self, name: str, seen: Observation) -> NDArray[Any]:
        reading = seen.sensor(name)
        if reading.shape != self.shapes[name] or reading.dtype != self.dtypes[name]:
            raise PolicyError(
                f"the sensor {name} returns {reading.dtype} {reading.shape}; the policy was trained with "
                f"{self.dtypes[name]} {self.shapes[name]}: fix [sensors.{name}] in submission.toml"
            )
        return reading


def _values(name: str, columns: Sequence[str], now: Moment) -> NDArray[np.float32]:
    if name in FACT_GROUPS:
        values = [_fact(now, column) for column in columns]
    else:
        group = GROUPS[name]
        by_name = dict(zip(group.columns, group.read(now), strict=True))
        values = [by_name[column] for column in columns]
    return np.array(values, np.float64).astype(np.float32)


def _columns_of(part: Mapping[str, Any]) -> tuple[str, ...] | None:
    """Return a part's columns; None for a sensor."""
    if "columns" not in part:
        return None
    name, columns = part["name"], tuple(part["columns"])
    known = GROUPS[name].columns if name in GROUPS else ()
    for column in columns:
        if not (_is_fact(column) if name in FACT_GROUPS else column in known):
            raise PolicyError(
                f"policy.json needs {column!r} of {name!r}, which this version of the SDK does not know: "
                "export the policy again with the version of wildscav that will play it"
            )
    return columns


def direction(seen: Observation, place: Vector | None) -> tuple[float, ...]:
    """Return the way from the agent's soles to a place by ``COLUMNS``; all 0 if it is not known."""
    if place is None:
        return (0.0,) * len(COLUMNS)
    east, up, north = (there - here for there, here in zip(place, seen.position, strict=True))
    distance = math.sqrt(east * east + up * up + north * north)
    far = exponential(-distance / NEAR), logarithm(1.0 + distance)
    if distance == 0.0:
        return (1.0, *(0.0,) * 6, *far)
    east, up, north = east / distance, up / distance, north / distance
    level = math.sqrt(east * east + north * north)
    shares = (
        *(east, up, north),
        east * cosine(seen.yaw) - north * sine(seen.yaw),
        east * sine(seen.yaw) + north * cosine(seen.yaw),
        up * cosine(seen.pitch) + level * sine(seen.pitch),
    )
    return (1.0, *(max(-1.0, min(1.0, share)) for share in shares), *far)
