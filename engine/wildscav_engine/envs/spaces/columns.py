"""The columns of a learner's row: named groups of numbers, each of which is a Box of the observation.

All groups of a learner are stored side by side in one float32 row, which one kernel writes. They are followed
by numbers that are not part of the observation: the outcome of the step, the events in it, and the terms of
its reward.
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

from wildscav_engine.sensors.base import Column
from wildscav_engine.specs.actions import Field
from wildscav_engine.tracks import Track

FAR = 5000.0  # m, beyond all coordinates on maps
FAST = 1000.0  # m/s, faster than any agent
LONG = 100_000.0  # s, longer than any match
MANY = 2.0**31  # above all counts
YES = "0 or 1"  # the unit of boolean columns
SHARE = "of 1"  # of numbers from -1 to 1
LOG_DISTANCE = "ln m"
FARTHEST = 10.0  # ln m, of any distance on maps


class Group(NamedTuple):
    """A named group of columns."""

    name: str
    columns: tuple[Column, ...]


class Part(IntEnum):
    """The parts of a row, by their numbers in kernels: the groups, then what follows them."""

    POSITION = 0
    VELOCITY = 1
    VIEW = 2
    BODY = 3
    TIME = 4
    TARGET = 5
    SUPPLIES = 6
    VITALS = 7
    WEAPON = 8
    OUTCOME = 9
    EVENTS = 10
    TERMS = 11
    TO_TARGET = 12
    TO_BOX = 13
    TO_ENEMY = 14


PARTS = len(Part)

GROUPS: dict[Part, Group] = {
    Part.POSITION: Group(
        "position",
        (
            Column("x", "m", -FAR, FAR, "position of the soles, east of the middle of the map"),
            Column("y", "m", -FAR, FAR, "height of the soles"),
            Column("z", "m", -FAR, FAR, "position of the soles, north of the middle of the map"),
        ),
    ),
    Part.VELOCITY: Group(
        "velocity",
        (
            Column("x", "m/s", -FAST, FAST, "velocity to the east in the last frame"),
            Column("y", "m/s", -FAST, FAST, "velocity upwards in the last frame"),
            Column("z", "m/s", -FAST, FAST, "velocity to the north in the last frame"),
        ),
    ),
    Part.VIEW: Group(
        "view",
        (
            Column("yaw", "degrees", -180.0, 180.0, "where the agent faces: 0 is north, 90 is east"),
            Column("pitch", "degrees", -90.0, 90.0, "how far the view looks down; negative looks up"),
            Column("sine of yaw", "", -1.0, 1.0, "the same yaw without the jump from 180 to -180"),
            Column("cosine of yaw", "", -1.0, 1.0, "the same yaw without the jump from 180 to -180"),
            Column("sine of pitch", "", -1.0, 1.0, "the same pitch"),
            Column("cosine of pitch", "", -1.0, 1.0, "the same pitch"),
        ),
    ),
    Part.BODY: Group(
        "body",
        (
            Column("alive", YES, 0.0, 1.0, "whether the agent is alive"),
            Column("on_ground", YES, 0.0, 1.0, "whether it stands on something"),
            Column("in_water", YES, 0.0, 1.0, "whether it wades in water"),
        ),
    ),
    Part.TIME: Group(
        "time",
        (
            Column("left", "s", 0.0, LONG, "game time until the time limit"),
            Column("passed", "s", 0.0, LONG, "game time since the start"),
        ),
    ),
    Part.TARGET: Group(
        "target",
        (
            Column("known", YES, 0.0, 1.0, "whether the target is known; the rest is 0 until it is"),
            Column("x", "m", -FAR, FAR, "position of the target, east of the middle of the map"),
            Column("y", "m", -FAR, FAR, "height of the target"),
            Column("z", "m", -FAR, FAR, "position of the target, north of the middle of the map"),
            Column("x from here", "m", -FAR, FAR, "position of the target, east of the soles"),
            Column("y from here", "m", -FAR, FAR, "position of the target, above the soles"),
            Column("z from here", "m", -FAR, FAR, "position of the target, north of the soles"),
            Column("distance", "m", 0.0, 2 * FAR, "straight distance of the target from the soles"),
        ),
    ),
    Part.SUPPLIES: Group(
        "supplies",
        (
            Column("carried", "", 0.0, MANY, "supplies that the agent carries"),
            Column("picked up in the step", "", 0.0, MANY, "supplies that it picked up in the last step"),
            Column("carried by the team", "", 0.0, MANY, "supplies that its team carries, its own included"),
            Column("can_pick_up", YES, 0.0, 1.0, "whether a supply box is within reach"),
        ),
    ),
    Part.VITALS: Group(
        "vitals",
        (
            Column("health", "hp", 0.0, 10_000.0, "health; 0 is dead"),
            Column("respawn_left", "s", 0.0, LONG, "time until a dead agent comes back"),
            Column("invincible_left", "s", 0.0, LONG, "time until shots do it harm again"),
        ),
    ),
    Part.WEAPON: Group(
        "weapon",
        (
            Column("clip", "", 0.0, MANY, "rounds in the weapon"),
            Column("spare_ammo", "", 0.0, MANY, "rounds carried besides"),
            Column("reload_left", "s", 0.0, LONG, "time until the weapon is reloaded"),
            Column("fired", YES, 0.0, 1.0, "whether the agent fired in the last step"),
            Column("hit", YES, 0.0, 1.0, "whether its last shot of the step hit another agent"),
            Column("was_hit", YES, 0.0, 1.0, "whether another agent hit it in the last step"),
        ),
    ),
}


def _direction(name: str, to: str, known: str) -> Group:
    """Return a group about the way to something: its direction, and its distance where near matters."""
    return Group(
        name,
        (
            Column("known", YES, 0.0, 1.0, f"{known}; the rest is 0 if not"),
            Column("east", SHARE, -1.0, 1.0, f"unit vector from the soles to {to}: its part to the east"),
            Column("up", SHARE, -1.0, 1.0, "the same vector's part upwards"),
            Column("north", SHARE, -1.0, 1.0, "the same vector's part to the north"),
            Column("right", SHARE, -1.0, 1.0, "the same vector's part to the right of the yaw"),
            Column("ahead", SHARE, -1.0, 1.0, "the same vector's part along the yaw"),
            Column("above the view", SHARE, -1.0, 1.0, "sine of how far it is above where the agent looks"),
            Column("nearness", SHARE, 0.0, 1.0, "1 at no distance, 0.37 at 5 m, 0.02 at 20 m: exp(-m / 5)"),
            Column("log distance", LOG_DISTANCE, 0.0, FARTHEST, "logarithm of 1 m + the distance"),
        ),
    )


_VIEW = GROUPS[Part.VIEW]
# What learners of version 1 observe besides, or in other units.
_NEW_GROUPS: dict[Part, Group] = {
    Part.VIEW: Group(
        _VIEW.name,
        (*_VIEW.columns[:2], *(column._replace(unit=SHARE) for column in _VIEW.columns[2:])),
    ),
    Part.TO_TARGET: _direction("to_target", "the target", "whether the target is known"),
    Part.TO_BOX: _direction("to_box", "the nearest supply box", "whether a supply box is in sight"),
    Part.TO_ENEMY: _direction(
        "to_enemy", "the nearest agent of another team", "whether an agent of another team is in sight"
    ),
}

# The groups whose columns are facts about the agent, those of ``Agents`` with the same names or with these.
# Columns in seconds are frames there, and YES is whatever is not the first value of the array.
FACT_PARTS = (Part.BODY, Part.VITALS, Part.WEAPON)
FACT_NAMES = {"alive": "health", "hit": "hit_seat", "was_hit": "hit_by_seat"}

# The outcome of a step for a learner.
OUTCOME = ("terminated", "truncated", "reward")
# Counts of a learner's events in the step.
EVENTS = ("shots", "hits", "was_hit", "supplies", "kills", "deaths", "respawns")


def groups_of(version: int) -> Mapping[Part, Group]:
    """Return all groups of a version of the observations."""
    return GROUPS if version == 0 else GROUPS | _NEW_GROUPS


def parts_of(track: Track, version: int) -> tuple[Part, ...]:
    """Return the groups that learners of a track observe in a version of the observations."""
    fights = Field.SHOOT in track.fields
    wanted = {
        Part.TARGET: track.has_target,
        Part.SUPPLIES: track.has_supplies,
        Part.VITALS: fights or track.has_zone,
        Part.WEAPON: fights,
        Part.TO_TARGET: track.has_target,
        Part.TO_BOX: track.has_supplies,
        Part.TO_ENEMY: fights,
    }
    return tuple(part for part in groups_of(version) if wanted.get(part, True))
