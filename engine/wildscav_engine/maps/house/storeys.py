"""One storey after the other: rooms, walls with openings, furniture."""

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.furniture import Gap, furnish
from wildscav_engine.maps.house.openings import (
    Edge,
    Face,
    choose_outer_doors,
    choose_terrace_door,
    draw_faces,
    edges_of,
    window,
    windows_in,
)
from wildscav_engine.maps.house.plan import (
    CLEAR_WAY,
    Furniture,
    Opening,
    OuterDoor,
    Room,
    Side,
    Stairs,
    Storey,
    Wall,
    Wing,
    line_of,
)
from wildscav_engine.maps.house.purposes import name_rooms
from wildscav_engine.maps.house.rooms import Door, Layout, choose_doors, divide, doorway
from wildscav_engine.maps.house.stairs import HallPlace

TRIES = 12  # to divide a storey so that doorways can join all rooms
SIDES = tuple(Side)
FURNISHED_HALL = 2.5  # m, how long a hall is, less the way to its stairs, that has furniture at its sides


class _Draft:
    """A storey while it is drawn."""

    def __init__(self, layout: Layout, faces: list[Face], inner: int) -> None:
        self.layout, self.faces = layout, faces
        self.inner = inner  # the first bars are inner walls, the others faces with a joint
        self.in_bars: list[list[Opening]] = [[] for _ in layout.bars]
        self.in_faces: list[list[Opening]] = [[] for _ in faces]
        self.gaps: list[list[Gap]] = [[] for _ in layout.rooms]

    def join(self, door: Door) -> None:
        """Make a doorway between two rooms."""
        bar, is_across = self.layout.bars[door.bar]
        if door.bar < self.inner:
            self.in_bars[door.bar].append(doorway(door.span))
        else:
            face = next(number for number, face in enumerate(self.faces) if face.outline == bar)
            self.in_faces[face].append(doorway(door.span))
        side = Side.FRONT if is_across else Side.RIGHT
        for room, seen in zip(door.rooms, (side, side.opposite), strict=True):
            self.gaps[room].append(Gap(seen, door.span, True))

    def open(self, edge: Edge, opening: Opening) -> None:
        """Make a door or window in an outer wall."""
        self.in_faces[edge.face].append(opening)
        self.gaps[edge.room].append(Gap(self.faces[edge.face].facing, edge.span, opening.is_doorway))


def draw_storey(
    dice: Dice, wings: tuple[Wing, ...], level: int, top: int, place: HallPlace | None, style: str
) -> tuple[Storey, list[int], list[OuterDoor]]:
    """Draw one storey.

    Args:
        dice: What is random.
        wings: The blocks of the house.
        level: Of the storey.
        top: The level that the stairs end at, a storey or the roof.
        place: Where the hall with stairs is, if there is one.
        style: Of the house.

    Returns:
        The storey, the wings whose roofs a doorway leads to, and the doorways to the ground.
    """
    stairs = place.stairs if place else None
    faces = draw_faces(wings, level)
    layout, inner, doors = _draw_layout(dice, wings, level, place, faces)
    draft = _Draft(layout, faces, inner)
    for door in doors:
        draft.join(door)
    terraces, doorways = _open_outwards(dice, draft, wings, level, top, stairs)
    names = name_rooms(dice, layout.rooms, stairs.hall if stairs else None, style, level)
    rooms = tuple(Room(area, name) for area, name in zip(layout.rooms, names, strict=True))
    storey = Storey(
        rooms=rooms,
        outer=tuple(
            Wall(face.outline, face.facing.is_across, tuple(sorted(openings)), face.facing)
            for face, openings in zip(faces, draft.in_faces, strict=True)
        ),
        inner=tuple(
            Wall(outline, is_across, tuple(sorted(openings)), None)
            for (outline, is_across), openings in zip(layout.bars[:inner], draft.in_bars[:inner], strict=True)
        ),
        furniture=tuple(_draw_furniture(dice, rooms, draft.gaps, stairs)),
        stairs=stairs if level < top else None,
        hole=stairs.well if stairs and level > 0 else None,
    )
    return storey, terraces, doorways


def can_be_joined(dice: Dice, wings: tuple[Wing, ...], place: HallPlace) -> bool:
    """Return whether doorways can join all parts of every storey around a hall with stairs."""
    for level in range(wings[0].storeys):
        layout, _ = _lay_out(dice, wings, level, place, draw_faces(wings, level), divided=False)
        if choose_doors(dice, layout, place.stairs) is None:
            return False
    return True


def _lay_out(
    dice: Dice,
    wings: tuple[Wing, ...],
    level: int,
    place: HallPlace | None,
    faces: list[Face],
    *,
    divided: bool,
) -> tuple[Layout, int]:
    """Return rooms and the walls between them, and how many of the walls are inner ones; they come first."""
    layout = Layout([], [])
    if place:
        layout.rooms.append(place.stairs.hall)
        layout.bars.extend(place.walls)
    blocks = list(place.rest) if place else [wings[0].inside]
    blocks += [wing.inside for wing in wings[1:] if level < wing.storeys]
    for block in blocks:
        if divided:
            divide(dice, block, layout)
        else:
            layout.rooms.append(block)
    inner = len(layout.bars)
    layout.bars.extend((face.outline, face.facing.is_across) for face in faces if face.joint)
    return layout, inner


def _draw_layout(
    dice: Dice, wings: tuple[Wing, ...], level: int, place: HallPlace | None, faces: list[Face]
) -> tuple[Layout, int, list[Door]]:
    """Divide a storey until doorways join all rooms; at worst into as few rooms as there can be."""
    for attempt in range(TRIES):
        layout, inner = _lay_out(dice, wings, level, place, faces, divided=attempt < TRIES - 1)
        doors = choose_doors(dice, layout, place.stairs if place else None)
        if doors is not None:
            return layout, inner, doors
    raise RuntimeError("a house has parts that no doorways can join")


def _open_outwards(
    dice: Dice, draft: _Draft, wings: tuple[Wing, ...], level: int, top: int, stairs: Stairs | None
) -> tuple[list[int], list[OuterDoor]]:
    """Make outer doors and windows; return the wings whose roofs a doorway leads to, and the outer doors."""
    edges = edges_of(draft.faces, draft.layout.rooms, stairs)
    doors, terraces = [], []
    if level == 0:
        hall = draft.layout.rooms.index(stairs.hall) if stairs else -1
        doors = choose_outer_doors(dice, draft.faces, edges, wings, hall)
    else:
        found = choose_terrace_door(dice, draft.faces, edges, wings, level)
        if found:
            terraces.append(found[0])
            doors.append(found[1])
    for door in doors:
        draft.open(door, doorway(door.span))
    # Where no stairs go on, there is nothing before the walls around the well.
    for edge in edges if level < top else edges_of(draft.faces, draft.layout.rooms, None):
        for span in windows_in(edge, doors):
            draft.open(edge._replace(span=span), window(span))
    return terraces, [_outer_door(draft.faces[door.face], door) for door in doors if level == 0]


def _outer_door(face: Face, door: Edge) -> OuterDoor:
    middle, line = (door.span[0] + door.span[1]) / 2.0, line_of(face.outline, face.facing)
    return OuterDoor((middle, line) if face.facing.is_across else (line, middle), face.facing)


def _draw_furniture(
    dice: Dice, rooms: tuple[Room, ...], gaps: list[list[Gap]], stairs: Stairs | None
) -> list[Furniture]:
    pieces = []
    for room, seen in zip(rooms, gaps, strict=True):
        if stairs and room.area == stairs.hall:
            pieces += _furnish_hall(dice, stairs, seen)
        else:
            pieces += furnish(dice, room.area, room.purpose, seen, SIDES)
    return pieces


def _furnish_hall(dice: Dice, stairs: Stairs, gaps: list[Gap]) -> list[Furniture]:
    """Furnish the end of a hall before its stairs, but not right before them."""
    side, hall = stairs.entry, stairs.hall
    ahead = CLEAR_WAY if side in (Side.FRONT, Side.RIGHT) else -CLEAR_WAY
    end = line_of(stairs.foot, side) + ahead
    length = abs(line_of(hall, side) - end)
    if length > FURNISHED_HALL:
        sides = tuple(other for other in SIDES if other is not side.opposite)
    else:
        # A short end has room at its far wall only; before that is the way.
        sides, end = (side,), end - ahead
    area = {
        Side.FRONT: hall._replace(back=end),
        Side.RIGHT: hall._replace(left=end),
        Side.BACK: hall._replace(front=end),
        Side.LEFT: hall._replace(right=end),
    }[side]
    return furnish(dice, area, "hall", [gap for gap in gaps if _is_before(area, gap)], sides)


def _is_before(area: Rectangle, gap: Gap) -> bool:
    """Return whether a gap of a hall is in its end before the stairs."""
    start, end = (area.left, area.right) if gap.side.is_across else (area.back, area.front)
    return gap.span[0] < end and gap.span[1] > start
