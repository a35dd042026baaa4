"""The data types of a house plan, in the axes of the house.

The axes of a house are *across* (to the right, seen from its middle towards its front) and *along* (towards
its front). Heights are relative to its ground floor.
"""

from enum import IntEnum
from typing import NamedTuple

from wildscav_engine.geometry.shapes import Rectangle

STOREY_HEIGHT = 3.0  # m, from floor to floor
SLAB = 0.2  # m, thickness of floors
OUTER_WALL, INNER_WALL = 0.25, 0.15  # m, thickness
DOOR_WIDTH, DOOR_HEIGHT = 1.6, 2.3  # m, clear
WINDOW_SILL, WINDOW_TOP = 1.0, DOOR_HEIGHT  # m above the floor; one lintel runs over doors and windows
PASSAGE_WIDTH = 1.6  # m, least width of every passage
NARROWEST_ROOM = 2.6  # m
TOUCHING = 1e-6  # m, within which two lines count as the same


class Side(IntEnum):
    """A side of a rectangle, or the direction outwards from it."""

    FRONT = 0
    RIGHT = 1
    BACK = 2
    LEFT = 3

    @property
    def is_across(self) -> bool:
        """Whether a wall on this side runs across; else it runs along."""
        return self % 2 == 0

    @property
    def opposite(self) -> "Side":
        """The opposite side."""
        return Side((self + 2) % 4)

    @property
    def aside(self) -> "Side":
        """A side at right angles to it."""
        return Side.RIGHT if self.is_across else Side.FRONT

    @property
    def is_ahead(self) -> bool:
        """Whether it has the greater coordinate of the two sides that are parallel."""
        return self in (Side.FRONT, Side.RIGHT)


def line_of(area: Rectangle, side: Side) -> float:
    """Return the coordinate of a side of a rectangle in m, on the axis perpendicular to the side."""
    return (area.front, area.right, area.back, area.left)[side]


def span_of(area: Rectangle, side: Side) -> tuple[float, float]:
    """Return the start and end of a side of a rectangle in m, on the axis parallel to the side."""
    return (area.left, area.right) if side.is_across else (area.back, area.front)


def with_line(area: Rectangle, side: Side, line: float) -> Rectangle:
    """Return a rectangle with one side moved to a coordinate in m; see ``line_of``."""
    return area._replace(**{("front", "right", "back", "left")[side]: line})


def part_of(area: Rectangle, side: Side, start: float, end: float) -> Rectangle:
    """Return the part of a rectangle between two coordinates in m on the axis parallel to a side."""
    if side.is_across:
        return area._replace(left=start, right=end)
    return area._replace(back=start, front=end)


def strip_at(area: Rectangle, side: Side, depth: float) -> Rectangle:
    """Return the strip of a depth in m along a side of a rectangle."""
    line = line_of(area, side)
    return with_line(area, side.opposite, line - depth if side.is_ahead else line + depth)


def shrunk(area: Rectangle, margin: float) -> Rectangle:
    """Return a rectangle shrunk by a margin in m on all sides."""
    return Rectangle(area.left + margin, area.back + margin, area.right - margin, area.front - margin)


class Roof(IntEnum):
    """The type of roof of a wing."""

    FLAT = 0  # with a parapet
    GABLE = 1
    HIP = 2
    LEAN_TO = 3  # one slope, down from the wall of a higher block


class Wing(NamedTuple):
    """A block of a house: the main one, or one that adjoins it."""

    outline: Rectangle  # walls included; a wing shares the wall between it and the main block
    storeys: int
    joint: Side | None  # its side that adjoins the main block; None for the main block itself
    roof: Roof

    @property
    def inside(self) -> Rectangle:
        """The area within its walls."""
        return shrunk(self.outline, OUTER_WALL)


class Opening(NamedTuple):
    """A doorway or window in a wall."""

    middle: float  # m, on the axis that the wall runs along
    width: float  # m
    bottom: float  # m above the floor
    top: float  # m above the floor

    @property
    def is_doorway(self) -> bool:
        """Whether it reaches down to the floor."""
        return self.bottom == 0.0

    @property
    def start(self) -> float:
        """Its start in m."""
        return self.middle - self.width / 2.0

    @property
    def end(self) -> float:
        """Its end in m."""
        return self.middle + self.width / 2.0


class Wall(NamedTuple):
    """A straight wall from floor to ceiling."""

    outline: Rectangle
    is_across: bool  # whether it runs across, else along
    openings: tuple[Opening, ...]  # ascending
    facing: Side | None  # the direction outwards; None for an inner wall

    @property
    def doorways(self) -> tuple[Opening, ...]:
        """Its doorways."""
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
    climbs: Side  # the direction in which it rises
    first: int  # number of steps below it, from the floor

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The middles of its lower and of its upper end."""
        left, back, right, front = self.outline
        middle = (left + right) / 2.0, (back + front) / 2.0
        foot, head = (line_of(self.outline, side) for side in (self.climbs.opposite, self.climbs))
        if self.climbs.is_across:
            return (middle[0], foot), (middle[0], head)
        return (foot, middle[1]), (head, middle[1])


class Stairs(NamedTuple):
    """The stairs of a house, identical between all storeys."""

    hall: Rectangle  # the room that contains them
    well: Rectangle  # their opening in each floor above
    flights: tuple[Flight, ...]
    landing: Rectangle | None  # halfway up, where they turn
    spine: Rectangle  # the wall between the flights, or beside a single one
    foot: Rectangle  # the edge of the well at the first step: a railing where no stairs lead on
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
