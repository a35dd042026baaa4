"""The columns of what a learner is told: named groups of numbers, each a Box of the observation.

All groups of a learner lie side by side in one float32 row, which one kernel writes; after them come numbers
that are not part of the observation: how the learner's match stands, what happened in the step, and what
was paid for it.
"""

from enum import IntEnum
from typing import NamedTuple

from wildscav_engine.actions import Field
from wildscav_engine.tracks import Track

FAR = 5000.0  # m, more than any place of a map has
FAST = 1000.0  # m/s, more than anybody has
LONG = 100_000.0  # s, more than any match takes
MANY = 2.0**31  # of anything that is counted


class Column(NamedTuple):
    """One number."""

    name: str
    unit: str
    low: float
    high: float


class Group(NamedTuple):
    """Numbers that belong together."""

    name: str
    columns: tuple[Column, ...]


def _yes(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "0 or 1", 0.0, 1.0) for name in names)


def _count(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "", 0.0, MANY) for name in names)


def _seconds(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "s", 0.0, LONG) for name in names)


def _metres(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "m", -FAR, FAR) for name in names)


def _distance(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "m", 0.0, 2 * FAR) for name in names)


def _unit(*names: str) -> tuple[Column, ...]:
    return tuple(Column(name, "", -1.0, 1.0) for name in names)


class Part(IntEnum):
    """The groups, by their numbers in kernels."""

    POSITION = 0
    VELOCITY = 1
    VIEW = 2
    BODY = 3
    TIME = 4
    TARGET = 5
    SUPPLIES = 6
    VITALS = 7
    WEAPON = 8
    STANDING = 9
    EVENTS = 10
    TERMS = 11


PARTS = len(Part)

GROUPS: dict[Part, Group] = {
    Part.POSITION: Group("position", _metres("x", "y", "z")),
    Part.VELOCITY: Group("velocity", tuple(Column(axis, "m/s", -FAST, FAST) for axis in ("x", "y", "z"))),
    Part.VIEW: Group(
        "view",
        (
            Column("yaw", "degrees", -180.0, 180.0),
            Column("pitch", "degrees", -90.0, 90.0),
            *_unit("sine of yaw", "cosine of yaw", "sine of pitch", "cosine of pitch"),
        ),
    ),
    Part.BODY: Group("body", _yes("alive", "on_ground", "in_water")),
    Part.TIME: Group("time", _seconds("left", "passed")),
    Part.TARGET: Group(
        "target",
        (
            *_yes("known"),
            *_metres("x", "y", "z", "x from here", "y from here", "z from here"),
            *_distance("distance"),
        ),
    ),
    Part.SUPPLIES: Group(
        "supplies", (*_count("carried", "picked up in the step", "carried by the team"), *_yes("can_pick_up"))
    ),
    Part.VITALS: Group(
        "vitals", (Column("health", "hp", 0.0, 10_000.0), *_seconds("respawn_left", "invincible_left"))
    ),
    Part.WEAPON: Group(
        "weapon",
        (*_count("clip", "spare_ammo"), *_seconds("reload_left"), *_yes("fired", "hit", "was_hit")),
    ),
}

STANDING = ("terminated", "truncated", "reward")
# What happened to a learner in the step, counted.
EVENTS = ("shots", "hits", "was_hit", "supplies", "kills", "deaths", "respawns")


def parts_of(track: Track) -> tuple[Part, ...]:
    """Return the groups that learners of a track are told."""
    fights = Field.SHOOT in track.fields
    wanted = {
        Part.TARGET: track.has_target,
        Part.SUPPLIES: track.has_supplies,
        Part.VITALS: fights or track.has_zone,
        Part.WEAPON: fights,
    }
    return tuple(part for part in GROUPS if wanted.get(part, True))
