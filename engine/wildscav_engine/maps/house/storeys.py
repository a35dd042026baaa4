"""Drawing the storeys of a house: rooms, walls with openings, furniture."""

from wildscav_engine.arithmetic.random_numbers import RandomStream
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
    NARROWEST_ROOM,
    PASSAGE_WIDTH,
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
    span_of,
    with_line,
)
from wildscav_engine.maps.house.rooms import Door, Layout, choose_doors, divide, doorway
from wildscav_engine.maps.house.stairs import HallPlace

TRIES = 12  # attempts to divide a storey so that doorways can connect all rooms
SIDES = tuple(Side)
# m, least length of a hall without the passage to its stairs, to have furniture at its sides
FURNISHED_HALL = 2.5
STYLES = ("dwelling", "dwelling", "dwelling", "store", "office")  # each entry is equally likely

# The purposes of a storey's rooms, the largest room first; the last one repeats.
GROUND: dict[str, tuple[str, ...]] = {
    "dwelling": ("living", "kitchen", "dining", "study", "bath", "pantry"),
    "store": ("store", "store", "workshop", "office", "store", "pantry"),
    "office": ("office", "dining", "office", "kitchen", "office"),
}
UPPER: dict[str, tuple[str, ...]] = {
    "dwelling": ("bedroom", "bedroom", "study", "bath", "bedroom"),
    "store": ("store", "workshop", "store", "bedroom", "pantry"),
    "office": ("office", "office", "study", "office"),
}


class _Draft:
    """A storey under construction."""

    def __init__(self, layout: Layout, faces: list[Face], inner: int) -> None:
        self.layout, self.faces = layout, faces
        self.inner = inner  # the first bars are inner walls, the others faces with a joint
        self.in_walls: list[list[Opening]] = [[] for _ in layout.walls]
        self.in_faces: list[list[Opening]] = [[] for _ in faces]
        self.gaps: list[list[Gap]] = [[] for _ in layout.rooms]

    def join(self, door: Door) -> None:
        """Add a doorway between two rooms."""
        wall, is_across = self.layout.walls[door.wall]
        if door.wall < self.inner:
            self.in_walls[door.wall].append(doorway(door.span))
        else:
            face = next(number for number, face in enumerate(self.faces) if face.outline == wall)
            self.in_faces[face].append(doorway(door.span))
        side = Side.FRONT if is_across else Side.RIGHT
        for room, seen in zip(door.rooms, (side, side.opposite), strict=True):
            self.gaps[room].append(Gap(seen, door.span, True))

    def open(self, edge: Edge, opening: Opening) -> None:
        """Add a door or window to an outer wall."""
        self.in_faces[edge.face].append(opening)
        self.gaps[edge.room].append(Gap(self.faces[edge.face].facing, edge.span, opening.is_doorway))


def draw_storey(
    dice: RandomStream, wings: tuple[Wing, ...], level: int, top: int, place: HallPlace | None, style: str
) -> tuple[Storey, list[int], list[OuterDoor]]:
    """Draw one storey of a house whose stairs, if it has a place for them, end at the level ``top``.

    It returns the storey, the wings to whose roofs a doorway leads, and the outer doors on the ground floor.
    """
    stairs = place.stairs if place else None
    faces = draw_faces(wings, level)
    layout, inner, doors = _draw_layout(dice, wings, level, place, faces)
    draft = _Draft(layout, faces, inner)
    for door in doors:
        draft.join(door)
    terraces, doorways = _open_outwards(dice, draft, wings, level, top, stairs)
    names = assign_purposes(dice, layout.rooms, stairs.hall if stairs else None, style, level)
    rooms = tuple(Room(area, name) for area, name in zip(layout.rooms, names, strict=True))
    storey = Storey(
        rooms=rooms,
        outer=tuple(
            Wall(face.outline, face.facing.is_across, tuple(sorted(openings)), face.facing)
            for face, openings in zip(faces, draft.in_faces, strict=True)
        ),
        inner=tuple(
            Wall(*wall, tuple(sorted(openings)), None)
            for wall, openings in zip(layout.walls[:inner], draft.in_walls[:inner], strict=True)
        ),
        furniture=tuple(_draw_furniture(dice, rooms, draft.gaps, stairs)),
        stairs=stairs if level < top else None,
        hole=stairs.well if stairs and level > 0 else None,
    )
    return storey, terraces, doorways


def can_be_joined(dice: RandomStream, wings: tuple[Wing, ...], place: HallPlace) -> bool:
    """Return whether doorways can connect all parts of every storey around a hall with stairs."""
    for level in range(wings[0].storeys):
        layout, _ = _lay_out(dice, wings, level, place, draw_faces(wings, level), divided=False)
        if choose_doors(dice, layout, place.stairs) is None:
            return False
    return True


def _lay_out(
    dice: RandomStream,
    wings: tuple[Wing, ...],
    level: int,
    place: HallPlace | None,
    faces: list[Face],
    *,
    divided: bool,
) -> tuple[Layout, int]:
    """Return the rooms and the walls between them, and the number of inner walls, which come first."""
    layout = Layout([], [])
    if place:
        layout.rooms.append(place.stairs.hall)
        layout.walls.extend(place.walls)
    blocks = list(place.rest) if place else [wings[0].inside]
    blocks += [wing.inside for wing in wings[1:] if level < wing.storeys]
    for block in blocks:
        if divided:
            divide(dice, block, layout)
        else:
            layout.rooms.append(block)
    inner = len(layout.walls)
    layout.walls.extend((face.outline, face.facing.is_across) for face in faces if face.joint)
    return layout, inner


def _draw_layout(
    dice: RandomStream, wings: tuple[Wing, ...], level: int, place: HallPlace | None, faces: list[Face]
) -> tuple[Layout, int, list[Door]]:
    """Divide a storey until doorways connect all rooms; the last attempt has as few rooms as possible."""
    for attempt in range(TRIES):
        layout, inner = _lay_out(dice, wings, level, place, faces, divided=attempt < TRIES - 1)
        doors = choose_doors(dice, layout, place.stairs if place else None)
        if doors is not None:
            return layout, inner, doors
    raise RuntimeError("a house has parts that no doorways can join")


def _open_outwards(
    dice: RandomStream, draft: _Draft, wings: tuple[Wing, ...], level: int, top: int, stairs: Stairs | None
) -> tuple[list[int], list[OuterDoor]]:
    """Add outer doors and windows; return the wings to whose roofs a doorway leads, and the outer doors."""
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
    # If no stairs lead on, the walls around the well are free.
    for edge in edges if level < top else edges_of(draft.faces, draft.layout.rooms, None):
        for span in windows_in(edge, doors):
            draft.open(edge._replace(span=span), window(span))
    return terraces, [_outer_door(draft.faces[door.face], door) for door in doors if level == 0]


def _outer_door(face: Face, door: Edge) -> OuterDoor:
    middle, line = (door.span[0] + door.span[1]) / 2.0, line_of(face.outline, face.facing)
    return OuterDoor((middle, line) if face.facing.is_across else (line, middle), face.facing)


def _draw_furniture(
    dice: RandomStream, rooms: tuple[Room, ...], gaps: list[list[Gap]], stairs: Stairs | None
) -> list[Furniture]:
    pieces = []
    for room, seen in zip(rooms, gaps, strict=True):
        if stairs and room.area == stairs.hall:
            pieces += _furnish_hall(dice, stairs, seen)
        else:
            pieces += furnish(dice, room.area, room.purpose, seen, SIDES)
    return pieces


def _furnish_hall(dice: RandomStream, stairs: Stairs, gaps: list[Gap]) -> list[Furniture]:
    """Furnish the end of a hall in front of its stairs, leaving a passage to them."""
    side, hall = stairs.entry, stairs.hall
    ahead = PASSAGE_WIDTH if side.is_ahead else -PASSAGE_WIDTH
    end = line_of(stairs.foot, side) + ahead
    length = abs(line_of(hall, side) - end)
    if length > FURNISHED_HALL:
        sides = tuple(other for other in SIDES if other is not side.opposite)
    else:
        # A short end has space only at its far wall, in front of the passage.
        sides, end = (side,), end - ahead
    area = with_line(hall, side.opposite, end)
    return furnish(dice, area, "hall", [gap for gap in gaps if _is_before(area, gap)], sides)


def _is_before(area: Rectangle, gap: Gap) -> bool:
    """Return whether a gap of a hall is in the part in front of its stairs."""
    start, end = span_of(area, gap.side)
    return gap.span[0] < end and gap.span[1] > start


def assign_purposes(
    dice: RandomStream, rooms: list[Rectangle], hall: Rectangle | None, style: str, level: int
) -> list[str]:
    """Return the purpose of each room of a storey."""
    wanted = (UPPER if level else GROUND)[style]
    names = [""] * len(rooms)
    # Rooms of similar size are ordered at random.
    order = sorted((-room.area * dice.uniform(0.8, 1.2), number) for number, room in enumerate(rooms))
    named = 0
    for _, number in order:
        room = rooms[number]
        if room == hall:
            names[number] = "hall"
        elif min(room.right - room.left, room.front - room.back) < NARROWEST_ROOM - 0.1:
            names[number] = "corridor"
        else:
            names[number] = wanted[min(named, len(wanted) - 1)]
            named += 1
    return names
