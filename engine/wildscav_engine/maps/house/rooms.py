"""Dividing a storey into rooms and connecting them by doorways."""

from itertools import product
from typing import NamedTuple

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import (
    DOOR_HEIGHT,
    DOOR_WIDTH,
    INNER_WALL,
    NARROWEST_ROOM,
    PASSAGE_WIDTH,
    TOUCHING,
    Opening,
    Side,
    Stairs,
    line_of,
    span_of,
)

Span = tuple[float, float]  # m, an interval on a line
WallLine = tuple[Rectangle, bool]  # the outline of a wall, and whether it runs across

CORRIDOR = 1.9  # m, width
LARGE_ROOM = 24.0  # m²; larger rooms are always divided
SMALL_ROOM = 13.0  # m²; smaller rooms are never divided
DOOR_MARGIN = 0.15  # m between a doorway and the corner of a room
LOOPS = 0.2  # share of the doorways not needed for connection that are made


class Layout(NamedTuple):
    """The rooms of a storey and the walls between them."""

    rooms: list[Rectangle]
    walls: list[WallLine]


class Door(NamedTuple):
    """A doorway between two rooms, or a place where one is possible."""

    wall: int  # index of the wall in a layout
    rooms: tuple[int, int]
    span: Span  # m, where it may be


def divide(dice: RandomStream, area: Rectangle, layout: Layout) -> None:
    """Divide a rectangle recursively into rooms by walls, and add them to a layout."""
    width, depth = area.right - area.left, area.front - area.back
    longer = max(width, depth)
    least = 2.0 * NARROWEST_ROOM + INNER_WALL
    size = width * depth
    if longer < least or size < SMALL_ROOM:
        layout.rooms.append(area)
        return
    # Larger and longer rooms are more likely to be divided.
    wish = (size - SMALL_ROOM) / (LARGE_ROOM - SMALL_ROOM) + max(0.0, longer / min(width, depth) - 1.5)
    if dice.uniform() >= wish:
        layout.rooms.append(area)
        return
    cuts_width = width >= depth if min(width, depth) < least or dice.uniform() < 0.8 else width < depth
    start, end = (area.left, area.right) if cuts_width else (area.back, area.front)
    if end - start >= least + CORRIDOR + INNER_WALL and size > 2.5 * LARGE_ROOM and dice.uniform() < 0.7:
        _cut_corridor(dice, area, cuts_width, layout)
        return
    share = dice.uniform(0.36, 0.64) * (end - start)
    place = min(max(share, NARROWEST_ROOM), end - start - NARROWEST_ROOM - INNER_WALL)
    first, rest = _cut(area, cuts_width, start + place, layout)
    divide(dice, first, layout)
    divide(dice, rest, layout)


def _cut(area: Rectangle, cuts_width: bool, place: float, layout: Layout) -> tuple[Rectangle, Rectangle]:
    """Put a wall across a rectangle and return both sides of it."""
    beyond = place + INNER_WALL
    if cuts_width:
        layout.walls.append((Rectangle(place, area.back, beyond, area.front), False))
        return area._replace(right=place), area._replace(left=beyond)
    layout.walls.append((Rectangle(area.left, place, area.right, beyond), True))
    return area._replace(front=place), area._replace(back=beyond)


def _cut_corridor(dice: RandomStream, area: Rectangle, cuts_width: bool, layout: Layout) -> None:
    """Divide a rectangle by a corridor from end to end."""
    start, end = (area.left, area.right) if cuts_width else (area.back, area.front)
    room = (end - start - CORRIDOR - 2.0 * INNER_WALL) - 2.0 * NARROWEST_ROOM
    place = start + NARROWEST_ROOM + room * dice.uniform(0.3, 0.7)
    first, rest = _cut(area, cuts_width, place, layout)
    corridor, last = _cut(rest, cuts_width, place + INNER_WALL + CORRIDOR, layout)
    layout.rooms.append(corridor)
    divide(dice, first, layout)
    divide(dice, last, layout)


def within(one: Span, other: Span) -> Span:
    """Return the intersection of two spans; if it is empty, it ends before it starts."""
    return max(one[0], other[0]), min(one[1], other[1])


def without(spans: list[Span], taken: Span) -> list[Span]:
    """Return the parts of spans outside another span."""
    left = []
    for start, end in spans:
        if taken[1] <= start or taken[0] >= end:
            left.append((start, end))
            continue
        if start < taken[0]:
            left.append((start, taken[0]))
        if taken[1] < end:
            left.append((taken[1], end))
    return left


def clear_of_stairs(room: Rectangle, side: Side, stairs: Stairs | None) -> list[Span]:
    """Return the parts of a room's side from which its stairs do not block the way into the room."""
    span = span_of(room, side)
    if stairs is None or room != stairs.hall:
        return [span]
    if abs(line_of(room, side) - line_of(stairs.well, side)) >= PASSAGE_WIDTH - TOUCHING:
        return [span]
    edges = [stairs.well, stairs.foot]
    return without([span], (min(span_of(e, side)[0] for e in edges), max(span_of(e, side)[1] for e in edges)))


def possible_doors(layout: Layout, stairs: Stairs | None) -> list[Door]:
    """Return all places where a doorway may connect two rooms."""
    doors = []
    for number, (wall, is_across) in enumerate(layout.walls):
        low, high = (Side.BACK, Side.LEFT)[not is_across], (Side.FRONT, Side.RIGHT)[not is_across]
        befores = _rooms_at(layout.rooms, wall, low)
        behinds = _rooms_at(layout.rooms, wall, high)
        for before, behind in product(befores, behinds):
            ahead = clear_of_stairs(layout.rooms[before], high, stairs)
            for one, other in product(ahead, clear_of_stairs(layout.rooms[behind], low, stairs)):
                start, end = within(one, other)
                if end - start >= DOOR_WIDTH + 2.0 * DOOR_MARGIN:
                    span = (start + DOOR_MARGIN, end - DOOR_MARGIN)
                    doors.append(Door(number, (before, behind), span))
    return doors


def _rooms_at(rooms: list[Rectangle], wall: Rectangle, side: Side) -> list[int]:
    """Return the rooms that touch one side of a wall."""
    line, span, facing = line_of(wall, side), span_of(wall, side), side.opposite
    found = []
    for number, room in enumerate(rooms):
        if abs(line_of(room, facing) - line) < TOUCHING:
            start, end = within(span, span_of(room, side))
            if end - start > TOUCHING:
                found.append(number)
    return found


def choose_doors(dice: RandomStream, layout: Layout, stairs: Stairs | None) -> list[Door] | None:
    """Choose doorways that connect all rooms: a random spanning tree, and some more.

    This is Kruskal's algorithm with random weights that favour doorways to the hall. It returns None if no
    doorways can connect all rooms.
    """
    hall = layout.rooms.index(stairs.hall) if stairs else -1
    weighted = sorted(
        (dice.uniform() + (0.0 if hall in door.rooms else 0.6), number, door)
        for number, door in enumerate(possible_doors(layout, stairs))
    )
    part = list(range(len(layout.rooms)))
    joined: set[tuple[int, int]] = set()
    chosen = []
    for _, _, door in weighted:
        one, other = part[door.rooms[0]], part[door.rooms[1]]
        if one == other and (door.rooms in joined or dice.uniform() >= LOOPS):
            continue
        part = [one if number == other else number for number in part]
        joined.add(door.rooms)
        chosen.append(door._replace(span=draw_span(dice, door.span, DOOR_WIDTH)))
    return chosen if len(set(part)) == 1 else None


def draw_span(dice: RandomStream, room: Span, width: float) -> Span:
    """Draw a span of a width in m inside another: at an end, or anywhere."""
    slack = room[1] - room[0] - width
    place = dice.uniform()
    start = room[0] + slack * (0.0 if place < 0.3 else 1.0 if place > 0.7 else dice.uniform())
    return start, start + width


def doorway(span: Span) -> Opening:
    """Return the doorway of a span."""
    return Opening((span[0] + span[1]) / 2.0, span[1] - span[0], 0.0, DOOR_HEIGHT)
