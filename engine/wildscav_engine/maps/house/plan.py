"""The words of a house plan: what a house is like inside, in its own axes, before anything is built.

A house's own axes are *across* (to the right, seen from its middle towards its front) and *along* (towards
its front); heights count from its ground floor.
"""

from enum import IntEnum
from typing import NamedTuple

from wildscav_engine.geometry.shapes import Rectangle

STOREY_HEIGHT = 3.0  # m, from floor to floor
SLAB = 0.2  # m, thickness of floors
OUTER_WALL, INNER_WALL = 0.25, 0.15  # m, thickness
DOOR_WIDTH, DOOR_HEIGHT = 1.6, 2.3  # m, clear
WINDOW_SILL, WINDOW_TOP = 1.0, DOOR_HEIGHT  # m above the floor; one lintel runs over doors and windows
CLEAR_WAY = 1.6  # m, least width of every way that one can walk
NARROWEST_ROOM = 2.6  # m
TOUCHING = 1e-6  # m, within which two lines are the same


class Side(IntEnum):
    """A side of a rectangle, or the direction out of it."""

    FRONT = 0
    RIGHT = 1
    BACK = 2
    LEFT = 3

    @property
    def is_across(self) -> bool:
        """Whether a wall on this side runs across, else along."""
        return self % 2 == 0

    @property
    def opposite(self) -> "Side":
        """The side that faces it."""
        return Side((self + 2) % 4)


def line_of(area: Rectangle, side: Side) -> float:
    """Return where a side of a rectangle lies in m, on the axis that crosses it."""
    return (area.front, area.right, area.back, area.left)[side]


def span_of(area: Rectangle, side: Side) -> tuple[float, float]:
    """Return where a side of a rectangle starts and ends in m, on the axis that it runs on."""
    return (area.left, area.right) if side.is_across else (area.back, area.front)


def shrunk(area: Rectangle, margin: float) -> Rectangle:
    """Return a rectangle less a margin in m on all sides."""
    return Rectangle(area.left + margin, area.back + margin, area.right - margin, area.front - margin)


class Roof(IntEnum):
    """What covers a part of a house."""

    FLAT = 0  # with a parapet
    GABLE = 1
    HIP = 2
    LEAN_TO = 3  # one slope, down from the wall of a higher block


class Wing(NamedTuple):
    """A block of a house: the main one, or one that adjoins it."""

    outline: Rectangle  # walls included; one that adjoins the main block shares the wall between them
    storeys: int
    joint: Side | None  # its side that adjoins the main block; none of the main block itself
    roof: Roof

    @property
    def inside(self) -> Rectangle:
        """All within its walls."""
        return shrunk(self.outline, OUTER_WALL)


class Opening(NamedTuple):
    """A doorway or window in a wall."""

    middle: float  # m, on the axis that the wall runs on
    width: float  # m
    bottom: float  # m above the floor
    top: float  # m above the floor

    @property
    def is_doorway(self) -> bool:
        """Whether it reaches down to the floor."""
        return self.bottom == 0.0

    @property
    def start(self) -> float:
        """Where it starts in m."""
        return self.middle - self.width / 2.0

    @property
    def end(self) -> float:
        """Where it ends in m."""
        return self.middle + self.width / 2.0


class Wall(NamedTuple):
    """A straight wall from floor to ceiling."""

    outline: Rectangle
    is_across: bool  # whether it runs across, else along
    openings: tuple[Opening, ...]  # ascending
    facing: Side | None  # where an outer wall looks; none of an inner wall

    @property
    def doorways(self) -> tuple[Opening, ...]:
        """Its openings that one can walk through."""
        return tuple(opening for opening in self.openings if opening.is_doorway)


class Room(NamedTuple):
    """A room: the clear rectangle between its walls."""

    area: Rectangle
    purpose: str


class Block(NamedTuple):
    """A box of a piece of furniture, or of the stairs."""

    area: Rectangle
    bottom: float  # m above the floor
    top: float  # m above the floor


class Furniture(NamedTuple):
    """A piece of furniture."""

    name: str
    outline: Rectangle
    blocks: tuple[Block, ...]


class Flight(NamedTuple):
    """A straight flight of steps."""

    outline: Rectangle
    climbs: Side  # where it leads up to
    first: int  # steps between the floor and its first step

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The middles of its foot and of its head."""
        middle = (
            (self.outline.left + self.outline.right) / 2.0,
            (self.outline.back + self.outline.front) / 2.0,
        )
        foot, head = (line_of(self.outline, side) for side in (self.climbs.opposite, self.climbs))
        if self.climbs.is_across:
            return (middle[0], foot), (middle[0], head)
        return (foot, middle[1]), (head, middle[1])


class Stairs(NamedTuple):
    """The stairs of a house, the same from each storey to the next."""

    hall: Rectangle  # the room that they are in
    well: Rectangle  # the hole that they need in each floor above
    flights: tuple[Flight, ...]
    landing: Rectangle | None  # half way up, where they turn
    spine: Rectangle  # the wall between the flights, or beside a single one
    foot: Rectangle  # the edge of the well before the first step: a railing where no stairs go on
    exit: Rectangle  # the edge of the well behind the last step
    entry: Side  # the end of the hall before the first step


class OuterDoor(NamedTuple):
    """A doorway out of the ground floor."""

    middle: tuple[float, float]  # m, across and along, of its outer edge
    facing: Side


class Storey(NamedTuple):
    """One storey."""

    rooms: tuple[Room, ...]
    outer: tuple[Wall, ...]  # with the walls between the main block and its wings
    inner: tuple[Wall, ...]
    furniture: tuple[Furniture, ...]
    stairs: Stairs | None  # up to the next storey, or to the roof
    hole: Rectangle | None  # in its floor, where stairs come up


class HousePlan(NamedTuple):
    """A whole house."""

    size: tuple[float, float]  # m, across and along, of all its wings together
    style: str
    wings: tuple[Wing, ...]  # the main block first
    storeys: tuple[Storey, ...]
    stairs: Stairs | None
    roof_exit: bool  # whether the stairs go on to the roof of the main block
    terraces: tuple[int, ...]  # the wings whose roof a doorway leads to
    doors: tuple[OuterDoor, ...]  # the front door first
