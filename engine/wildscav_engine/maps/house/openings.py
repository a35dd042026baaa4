"""The outer walls of a storey, and their doors and windows."""

from typing import NamedTuple

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import (
    DOOR_WIDTH,
    OUTER_WALL,
    TOUCHING,
    WINDOW_SILL,
    WINDOW_TOP,
    Opening,
    Roof,
    Side,
    Stairs,
    Wing,
    line_of,
    part_of,
    span_of,
    strip_at,
)
from wildscav_engine.maps.house.rooms import Span, clear_of_stairs, draw_span, within, without

PILLAR = 0.3  # m, least width of wall beside a window or door
WINDOW_BAY = 3.0  # m of wall for each window, approximately
NARROWEST_WINDOW, WIDEST_WINDOW = 0.8, 1.8  # m
LARGE_HOUSE = 120.0  # m² of ground, above which a house has a second door


class Face(NamedTuple):
    """An outer wall of a storey before it has openings."""

    wing: int
    outline: Rectangle
    facing: Side
    open: list[Span]  # m, the parts of it with open air outside
    joint: bool  # whether a wing of the same storey adjoins it


def draw_faces(wings: tuple[Wing, ...], level: int) -> list[Face]:
    """Return the outer walls of a storey; a wall shared with a wing belongs to the main block."""
    main, others = wings[0], wings[1:]
    faces = []
    for side in Side:
        outline = strip_along(main.outline, side)
        span = span_of(outline, side)
        bare, joint = [span], False
        for wing in others:
            if wing.joint is not side.opposite:
                continue
            shared = span_of(wing.outline, side)
            if level < wing.storeys:
                joint = True
                bare = without(bare, shared)
            elif level == wing.storeys and wing.roof is not Roof.FLAT:
                bare = without(bare, shared)
        faces.append(Face(0, outline, side, bare, joint))
    for number, wing in enumerate(others, start=1):
        if level < wing.storeys:
            faces += _faces_of_wing(number, wing)
    return faces


def _faces_of_wing(number: int, wing: Wing) -> list[Face]:
    faces = []
    for side in Side:
        if side is wing.joint:
            continue
        outline = strip_along(wing.outline, side)
        # Walls that run across include the corners, but do not reach into the wall of the main block.
        if side.is_across and wing.joint is Side.LEFT:
            outline = outline._replace(left=outline.left + OUTER_WALL)
        elif side.is_across and wing.joint is Side.RIGHT:
            outline = outline._replace(right=outline.right - OUTER_WALL)
        faces.append(Face(number, outline, side, [span_of(outline, side)], False))
    return faces


def strip_along(outline: Rectangle, side: Side, thickness: float = OUTER_WALL) -> Rectangle:
    """Return the wall along a side of a block; walls that run across include the corners."""
    strip = strip_at(outline, side, thickness)
    if side.is_across:
        return strip
    return part_of(strip, side, outline.back + thickness, outline.front - thickness)


class Edge(NamedTuple):
    """A part of an outer wall with a room inside and open air outside."""

    face: int
    room: int
    span: Span  # m


def edges_of(faces: list[Face], rooms: list[Rectangle], stairs: Stairs | None) -> list[Edge]:
    """Return where doors and windows may be: nowhere with stairs behind the wall."""
    edges = []
    for number, face in enumerate(faces):
        line, side = line_of(face.outline, face.facing.opposite), face.facing
        for room, area in enumerate(rooms):
            if abs(line_of(area, side) - line) > TOUCHING:
                continue
            for clear in clear_of_stairs(area, side, stairs):
                for bare in face.open:
                    start, end = within(clear, bare)
                    if end - start > TOUCHING:
                        edges.append(Edge(number, room, (start, end)))
    return edges


def choose_outer_doors(
    dice: RandomStream, faces: list[Face], edges: list[Edge], wings: tuple[Wing, ...], hall: int
) -> list[Edge]:
    """Choose the front door, preferably into the hall, and for a large house a second one on another side."""
    wide = [edge for edge in edges if edge.span[1] - edge.span[0] >= DOOR_WIDTH + 2.0 * PILLAR]
    fronts = [edge for edge in wide if faces[edge.face].facing is Side.FRONT] or wide
    in_hall = [edge for edge in fronts if edge.room == hall]
    front = _draw(dice, in_hall if in_hall and dice.uniform() < 0.8 else fronts)
    doors = [front]
    if sum(wing.outline.area for wing in wings) >= LARGE_HOUSE:
        others = [edge for edge in wide if edge.room != front.room and edge.face != front.face]
        backs = [edge for edge in others if faces[edge.face].facing is Side.BACK]
        if others:
            doors.append(_draw(dice, backs if backs and dice.uniform() < 0.6 else others))
    return [_place(dice, door) for door in doors]


def choose_terrace_door(
    dice: RandomStream, faces: list[Face], edges: list[Edge], wings: tuple[Wing, ...], level: int
) -> tuple[int, Edge] | None:
    """Choose a door to the flat roof of a lower wing, and return it with its wing; None without one."""
    for number, wing in enumerate(wings):
        if wing.joint is None or wing.storeys != level or wing.roof is not Roof.FLAT:
            continue
        before = span_of(wing.inside, wing.joint)
        spans = [
            edge._replace(span=within(edge.span, before))
            for edge in edges
            if faces[edge.face].wing == 0 and faces[edge.face].facing is wing.joint.opposite
        ]
        wide = [edge for edge in spans if edge.span[1] - edge.span[0] >= DOOR_WIDTH + 2.0 * PILLAR]
        if wide:
            return number, _place(dice, _draw(dice, wide))
    return None


def _draw(dice: RandomStream, edges: list[Edge]) -> Edge:
    return edges[dice.integer(0, len(edges) - 1)]


def _place(dice: RandomStream, edge: Edge) -> Edge:
    start, end = edge.span
    return edge._replace(span=draw_span(dice, (start + PILLAR, end - PILLAR), DOOR_WIDTH))


def windows_in(edge: Edge, doors: list[Edge]) -> list[Span]:
    """Return the windows of a part of an outer wall: evenly spaced, but none at a door."""
    start, end = edge.span[0] + PILLAR, edge.span[1] - PILLAR
    if end - start < NARROWEST_WINDOW:
        return []
    bays = max(1, round((end - start) / WINDOW_BAY))
    step = (end - start) / bays
    width = min(WIDEST_WINDOW, max(NARROWEST_WINDOW, 0.55 * step))
    taken = [(door.span[0] - PILLAR, door.span[1] + PILLAR) for door in doors if door.face == edge.face]
    windows = []
    for bay in range(bays):
        middle = start + (bay + 0.5) * step
        window = (middle - width / 2.0, middle + width / 2.0)
        if all(window[1] <= first or last <= window[0] for first, last in taken):
            windows.append(window)
    return windows


def window(span: Span) -> Opening:
    """Return the window of a span."""
    return Opening((span[0] + span[1]) / 2.0, span[1] - span[0], WINDOW_SILL, WINDOW_TOP)
