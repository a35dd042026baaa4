"""The document from which a page shows a match: what its agents did, the safe zone, and results.

All lengths are whole centimetres, angles whole degrees, and times frames (``frames_per_second`` of them are a
second of the match), so that the document stays small. North is +z, east is +x. A list of samples or of shots
begins with a number, and goes on with what each is more than the one before.
"""

import gzip
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any, Final, Literal, Self

from pydantic import BaseModel, ConfigDict

from wildscav_stage.scene.arrays import LEVEL

TRAILS_VERSION: Final = 3  # of the document; it moves when a field changes its meaning or goes

EventKind = Literal["hit", "death", "out", "respawn", "pick_up", "target", "zone"]
Differences = list[int]


def differences(values: Sequence[int]) -> Differences:
    """Return the first number, and how much more each of the others is than the one before."""
    return [*values[:1], *(after - before for before, after in pairwise(values))]


def values_of(differences: Differences) -> list[int]:
    """Return the numbers that ``differences`` stands for."""
    return list(accumulate(differences))


class Part(BaseModel):
    """Base of the document and its parts."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def about(cls, source: object, **others: Any) -> Self:
        """Return a part of what something has of its fields, and of the others that are given."""
        names = [name for name in cls.model_fields if name not in others and hasattr(source, name)]
        return cls.model_validate({name: getattr(source, name) for name in names} | others)

    def compressed(self) -> bytes:
        """Return the part as compressed JSON, always the same bytes."""
        return gzip.compress(self.model_dump_json().encode(), LEVEL, mtime=0)


class SeatResultShown(Part):
    """What a seat achieved by the end of the match."""

    supplies: int
    kills: int
    deaths: int
    shots: int
    hits: int
    metrics: dict[str, float]  # by the names of the track's metrics


class SeatShown(Part):
    """A seat of the match."""

    seat: int
    name: str  # chosen by a competitor
    kind: str  # "submission" or a robot's name
    team: int
    colors: list[list[int]]  # of the parts of its body: red, green and blue, 0-255
    full_health: int  # hp
    result: SeatResultShown | None  # None while the match is being played


class SeatSamples(Part):
    """The course of one seat; each list has one entry for each frame of ``Samples.frames``."""

    x: Differences  # cm
    z: Differences  # cm
    height: Differences  # cm, of the soles
    yaw: Differences  # degrees, 0 faces north, grows clockwise; it does not jump where a turn is whole
    pitch: Differences  # degrees, positive looks down
    health: Differences  # hp, 0 = dead
    supplies: Differences  # carried


class Samples(Part):
    """The course of all seats."""

    frames: Differences
    seats: list[SeatSamples]


class Shots(Part):
    """The shots of all seats, in the order of their frames; each list has one entry for each."""

    frames: Differences  # at whose ends they had been fired
    seats: Differences  # that fired
    x: Differences  # cm, where they ended
    z: Differences  # cm
    height: Differences  # cm


class Event(Part):
    """Something that happened.

    ``seat`` did it, or it happened to it: it hit ``other``, died or left the match (shot by ``other``, if
    anyone), came back, picked up ``amount`` supplies, or reached the target. An event of the zone has no
    seat; its ``amount`` is 1 when the zone begins to shrink, and 0 when it has shrunk.
    """

    frame: int
    kind: EventKind
    seat: int | None = None
    other: int | None = None
    amount: int = 0  # of "hit": the hp that the other has left


class Circle(Part):
    """A circle on the map."""

    x: int  # cm
    z: int  # cm
    radius: int  # cm


class ZonePhase(Part):
    """A phase of the safe zone, which moves at constant speed from ``start`` to ``end``."""

    start: int  # frame
    end: int  # frame
    before: Circle
    after: Circle


class Box(Part):
    """A box of supplies that lies on the map from a frame until it is taken."""

    x: int  # cm
    z: int  # cm
    height: int  # cm
    dropped: bool  # by an agent that died
    quantity: int
    appears: int  # frame
    taken: int | None  # frame; None if it stays


class Target(Part):
    """The target of the match."""

    x: int  # cm
    z: int  # cm
    height: int  # cm


class News(Part):
    """What spectators of a match that is being played are told next.

    Boxes are those that have appeared. ``taken`` has the place of each that is gone, among all in the order
    in which they appeared, and the frame.
    """

    samples: Samples
    shots: Shots
    events: list[Event]
    boxes: list[Box]
    taken: list[tuple[int, int]]


class Trails(Part):
    """A match, as a page shows it; of one that is being played, its beginning, which news go on with."""

    version: Literal[3] = TRAILS_VERSION
    over: bool  # whether the match has ended; False while it is being played
    delay: float = 0.0  # s from a moment of a match that is being played until its news are sent, as a rule
    track: str
    title: str  # of the track
    frames_per_second: int
    frames: int  # played
    frame_limit: int
    ending: str  # "none", "time_up", "goal" or "last_standing"
    # One sentence without a full stop, with names of competitors; empty while it is being played.
    outcome: str
    target: Target | None
    seats: list[SeatShown]
    samples: Samples
    shots: Shots
    events: list[Event]
    zone: list[ZonePhase]
    boxes: list[Box]
