"""The document from which a page shows a match from above: trails, events, the safe zone, and results.

All lengths are whole decimetres, angles whole degrees, and times frames (``frames_per_second`` of them are a
second of the match), so that the document stays small. North is +z, east is +x.
"""

from typing import Final, Literal

from wildscav_evaluator.output.json_files import FileModel

TRAILS_VERSION: Final = 1  # of the document; it moves when a field changes its meaning or goes

EventKind = Literal["hit", "death", "out", "respawn", "pick_up", "target", "zone"]


class MapExtent(FileModel):
    """The part of the world that the map covers."""

    west: int  # dm, x of its western edge
    north: int  # dm, z of its northern edge
    width: int  # dm, from west to east
    height: int  # dm, from north to south


class SeatResultShown(FileModel):
    """What a seat achieved by the end of the match."""

    supplies: int
    kills: int
    deaths: int
    shots: int
    hits: int
    walked: int  # dm
    metrics: dict[str, float]  # by the names of the track's metrics


class SeatShown(FileModel):
    """A seat of the match."""

    seat: int
    name: str  # chosen by a competitor
    kind: str  # "submission" or a robot's name
    team: int
    full_health: int  # hp
    result: SeatResultShown | None  # None while the match is being played


class SeatSamples(FileModel):
    """The course of one seat; each list has one entry for each frame of ``Samples.frames``."""

    x: list[int]  # dm
    z: list[int]  # dm
    height: list[int]  # dm, of the soles
    yaw: list[int]  # degrees, 0 faces north, grows clockwise
    health: list[int]  # hp, 0 = dead
    supplies: list[int]  # carried


class Samples(FileModel):
    """The course of all seats."""

    frames: list[int]
    seats: list[SeatSamples]


class Event(FileModel):
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


class Circle(FileModel):
    """A circle on the map."""

    x: int  # dm
    z: int  # dm
    radius: int  # dm


class ZonePhase(FileModel):
    """A phase of the safe zone, which moves at constant speed from ``start`` to ``end``."""

    start: int  # frame
    end: int  # frame
    before: Circle
    after: Circle
    damage: int  # hp per second outside


class Box(FileModel):
    """A box of supplies that lies on the map from a frame until it is taken."""

    x: int  # dm
    z: int  # dm
    quantity: int
    appears: int  # frame
    taken: int | None  # frame; None if it stays


class Target(FileModel):
    """The target of the match."""

    x: int  # dm
    z: int  # dm
    height: int  # dm


class Trails(FileModel):
    """A match, seen from above.

    Of a match that is being played, a document holds the samples and events after a cursor; the next one is
    asked for with ``cursor``. ``first`` says whether this is the beginning.
    """

    version: Literal[1] = TRAILS_VERSION
    over: bool  # whether the match has ended; False while it is being played
    first: bool = True  # whether samples and events begin with the match
    cursor: str = ""  # of a match that is being played: where the next document goes on
    track: str
    title: str  # of the track
    frames_per_second: int
    frames: int  # played so far
    frame_limit: int
    ending: str  # "none", "time_up", "goal" or "last_standing"
    # One sentence without a full stop, with names of competitors; empty while it is being played.
    outcome: str
    map: MapExtent
    target: Target | None
    seats: list[SeatShown]
    samples: Samples
    events: list[Event]
    zone: list[ZonePhase]
    boxes: list[Box]
