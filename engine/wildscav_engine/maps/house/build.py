"""Building the convex solids of a house from its plan."""

from wildscav_engine.geometry.shapes import Pose, Rectangle, boxes, lean_to, pitched_roof
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.house.openings import draw_faces, strip_along
from wildscav_engine.maps.house.plan import (
    DOOR_HEIGHT,
    OUTER_WALL,
    SLAB,
    STOREY_HEIGHT,
    TOUCHING,
    WINDOW_SILL,
    HousePlan,
    Roof,
    Side,
    Stairs,
    Wall,
    Wing,
    part_of,
    span_of,
    strip_at,
)
from wildscav_engine.maps.house.rooms import without
from wildscav_engine.maps.house.stairs import EDGE, LANDING_HEIGHT, steps_of
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.settlements.houses import Room as MapRoom
from wildscav_engine.maps.settlements.sites import Site

STEP_THICKNESS = 0.1  # m, of steps above other stairs: thin treads leave more headroom below
RAILING = 1.0  # m, height
FLOOR_LIFT = 0.08  # m of the ground floor above the levelled ground
FOUNDATION = 0.5  # m that the house reaches into the ground
PARAPET = 0.5  # m, height
RAILED_PARAPET = 0.95  # m, height on roofs that can be walked to
# m; slightly less than the wall, so that its inner side is coplanar with no other surface
PARAPET_THICKNESS = 0.2
EAVES, OVERHANG = 0.15, 0.4  # m
SLOPE = 0.62  # rise of pitched roofs per m from the eaves
LEAN_TO_RISE = 0.85  # m; less than the sills of the storey above
WING_LIFT = 0.03  # m that the roof of a wing is raised, so that no faces are coplanar
EXIT_HEIGHT = 2.5  # m, inside the stair house


class Builder:
    """Collects the boxes of one house and builds all of them at once."""

    def __init__(self, where: Pose, ground: float) -> None:
        """Start at a pose, with the ground floor at a height in m."""
        self.where = where
        self.ground = ground
        self._kinds: list[Kind] = []
        self._corners: list[tuple[float, ...]] = []

    def block(self, kind: Kind, area: Rectangle, bottom: float, top: float) -> None:
        """Add a box over a rectangle, unless it is only as thick as a rounding error."""
        if min(area.right - area.left, area.front - area.back) < TOUCHING:
            return
        self._kinds.append(kind)
        low, high = self.ground + bottom, self.ground + top
        self._corners.append((area.left, low, area.back, area.right, high, area.front))

    def solids(self) -> list[Solid]:
        """Return the boxes as solids."""
        return boxes(self._kinds, self.where, self._corners)

    def wall(self, wall: Wall, floor: float, bottom: float, top: float) -> None:
        """Add a wall: one lintel over all its openings, pillars between them, sills under windows.

        Openings are above ``floor`` m, and the wall reaches from ``bottom`` to ``top`` m.
        """
        side = Side.FRONT if wall.is_across else Side.RIGHT
        ends = [span_of(wall.outline, side)]
        if not wall.openings:
            self.block(Kind.WALL, wall.outline, bottom, top)
            return
        sill, lintel = floor + WINDOW_SILL, floor + DOOR_HEIGHT
        self.block(Kind.WALL, wall.outline, lintel, top)
        for door in wall.doorways:
            ends = without(ends, (door.start, door.end))
            if bottom < floor:
                self.block(Kind.FLOOR, part_of(wall.outline, side, door.start, door.end), bottom, floor)
        for start, end in ends:
            windows = [other for other in wall.openings if start < other.middle < end]
            part = part_of(wall.outline, side, start, end)
            self.block(Kind.WALL, part, bottom, sill if windows else lintel)
            pillars = [(start, end)] if windows else []
            for window in windows:
                pillars = without(pillars, (window.start, window.end))
            for pillar in pillars:
                self.block(Kind.WALL, part_of(wall.outline, side, *pillar), sill, lintel)

    def floor(self, area: Rectangle, hole: Rectangle | None, bottom: float, top: float) -> None:
        """Add a floor with a rectangular hole."""
        for part in around_hole(area, hole):
            self.block(Kind.FLOOR, part, bottom, top)

    def stairs(self, stairs: Stairs, floor: float, *, hangs: bool) -> None:
        """Add the stairs from a floor, in m, to the next.

        If they hang, other stairs below need headroom; else they stand on the floor.
        """
        for flight in stairs.flights:
            for area, height in steps_of(flight):
                bottom = floor + (height - STEP_THICKNESS if hangs else 0.0)
                self.block(Kind.STAIR, area, bottom, floor + height)
        if stairs.landing:
            bottom = floor + (LANDING_HEIGHT - SLAB if hangs else 0.0)
            self.block(Kind.STAIR, stairs.landing, bottom, floor + LANDING_HEIGHT)


def around_hole(area: Rectangle, hole: Rectangle | None) -> list[Rectangle]:
    """Return rectangles that cover an area except the hole in it."""
    if hole is None:
        return [area]
    parts = [
        area._replace(front=hole.back),
        area._replace(back=hole.front),
        Rectangle(area.left, hole.back, hole.left, hole.front),
        Rectangle(hole.right, hole.back, area.right, hole.front),
    ]
    return [part for part in parts if min(part.right - part.left, part.front - part.back) > TOUCHING]


def build_house(plan: HousePlan, site: Site) -> list[Solid]:
    """Return all solids of a house."""
    builder = Builder(site.pose, site.ground + FLOOR_LIFT)
    for level, storey in enumerate(plan.storeys):
        floor = level * STOREY_HEIGHT
        foundation = FOUNDATION if level == 0 else 0.0
        for wall in storey.outer:
            builder.wall(wall, floor, floor - foundation, floor + STOREY_HEIGHT)
        for wall in storey.inner:
            builder.wall(wall, floor, floor, floor + STOREY_HEIGHT - SLAB)
        for number, wing in enumerate(plan.wings):
            if level < wing.storeys:
                hole = storey.hole if number == 0 else None
                builder.floor(wing.inside, hole, floor - (foundation or SLAB), floor)
        if storey.stairs:
            builder.stairs(storey.stairs, floor, hangs=level > 0)
        if plan.stairs:
            _build_guards(builder, plan.stairs, level, floor, goes_on=storey.stairs is not None)
        for piece in storey.furniture:
            for block in piece.blocks:
                builder.block(Kind.FURNITURE, block.area, floor + block.bottom, floor + block.top)
    roofs = build_roofs(builder, plan)
    return builder.solids() + roofs


def _build_guards(builder: Builder, stairs: Stairs, level: int, floor: float, *, goes_on: bool) -> None:
    """Build the wall or railing beside flights, and the railing at a well from which no stairs lead on."""
    if stairs.landing:
        top = STOREY_HEIGHT if goes_on else RAILING
        builder.block(Kind.WALL, stairs.spine, floor, floor + top)
    elif level > 0:
        builder.block(Kind.WALL, stairs.spine, floor, floor + RAILING)
    if not goes_on:
        builder.block(Kind.WALL, stairs.foot, floor, floor + RAILING)


def doorsteps(plan: HousePlan, site: Site, distance: float) -> list[tuple[float, float]]:
    """Return x and z in m of the place in front of each outer doorway, ``distance`` m from the wall."""
    places = []
    for (across, along), side in plan.doors:
        away = distance if side.is_ahead else -distance
        place = (across, along + away) if side.is_across else (across + away, along)
        places.append(site.pose.outside(*place))
    return places


def house_of(plan: HousePlan, site: Site) -> House:
    """Return the house of a map for a plan on a site."""
    rooms = [MapRoom(level, room.area) for level, storey in enumerate(plan.storeys) for room in storey.rooms]
    return House(
        center=(site.pose.x, site.pose.z),
        size=plan.size,
        yaw=site.yaw,
        ground=site.ground + FLOOR_LIFT,
        storeys=len(plan.storeys),
        storey_height=STOREY_HEIGHT,
        wings=tuple(wing.outline for wing in plan.wings),
        rooms=tuple(rooms),
    )


def build_roofs(builder: Builder, plan: HousePlan) -> list[Solid]:
    """Return the pitched roofs of all wings; flat roofs and attic floors are added to the builder."""
    solids = []
    for number, wing in enumerate(plan.wings):
        top = wing.storeys * STOREY_HEIGHT
        hole = plan.stairs.well if plan.roof_exit and plan.stairs and number == 0 else None
        kind = Kind.ROOF if wing.roof is Roof.FLAT else Kind.FLOOR
        for part in around_hole(wing.inside, hole):
            builder.block(kind, part, top - SLAB, top)
        if wing.roof is Roof.FLAT:
            height = RAILED_PARAPET if can_be_walked_to(plan, number) else PARAPET
            _build_parapet(builder, plan.wings, number, top, height)
        elif wing.roof is Roof.LEAN_TO:
            solids.append(_build_lean_to(builder, wing, top))
        else:
            solids.append(_build_pitched(builder, plan.wings, number, top))
    if plan.roof_exit and plan.stairs:
        _build_exit(builder, plan.stairs, plan.wings[0].storeys * STOREY_HEIGHT)
    return solids


def can_be_walked_to(plan: HousePlan, number: int) -> bool:
    """Return whether the roof of a wing can be walked to."""
    wing = plan.wings[number]
    level_with_main = wing.storeys == plan.wings[0].storeys
    return wing.roof is Roof.FLAT and (number in plan.terraces or (plan.roof_exit and level_with_main))


def _build_parapet(builder: Builder, wings: tuple[Wing, ...], number: int, top: float, height: float) -> None:
    """Build parapets on the outer walls, but not between flat roofs that adjoin each other."""
    wing = wings[number]
    for face in draw_faces(wings, wing.storeys - 1):
        if face.wing != number:
            continue
        outline = strip_at(face.outline, face.facing, PARAPET_THICKNESS)
        spans = [span_of(outline, face.facing)]
        for other in wings[1:]:
            if number == 0 and other.joint is face.facing.opposite and other.storeys == wing.storeys:
                spans = without(spans, span_of(other.inside, face.facing))
        for start, end in spans:
            builder.block(Kind.WALL, part_of(outline, face.facing, start, end), top, top + height)


def _turned(where: Pose, area: Rectangle, towards: Side) -> tuple[Pose, Rectangle]:
    """Return the pose rotated to face a side, and a rectangle in its axes."""
    left, back, right, front = area
    if towards is Side.FRONT:
        return where, area
    if towards is Side.BACK:
        turned = where._replace(sine=-where.sine, cosine=-where.cosine)
        return turned, Rectangle(-right, -front, -left, -back)
    if towards is Side.RIGHT:
        turned = where._replace(sine=where.cosine, cosine=-where.sine)
        return turned, Rectangle(-front, left, -back, right)
    turned = where._replace(sine=-where.cosine, cosine=where.sine)
    return turned, Rectangle(back, -right, front, -left)


def _build_pitched(builder: Builder, wings: tuple[Wing, ...], number: int, top: float) -> Solid:
    """Build a gable or hip roof; the ridge runs along the longer side of a main block, outwards on a wing."""
    wing, main = wings[number], wings[0]
    left, back, right, front = wing.outline
    towards = Side.FRONT if front - back >= right - left else Side.RIGHT
    if wing.joint is not None:
        towards = wing.joint.opposite
    where, area = _turned(builder.where, wing.outline, towards)
    start, bottom = area.back - OVERHANG, top
    half = (area.right - area.left) / 2.0 + OVERHANG
    rise = SLOPE * half
    if wing.joint is not None:
        # It ends at the wall of a higher main block, or inside the roof of one of equal height.
        start, bottom = area.back + OUTER_WALL, top + WING_LIFT
        if wing.storeys == main.storeys:
            deep = _turned(builder.where, main.outline, towards)[1]
            start -= (deep.front - deep.back) / 2.0
            across, along = main.outline.right - main.outline.left, main.outline.front - main.outline.back
            rise = min(rise, SLOPE * (min(across, along) / 2.0 + OVERHANG) - 2.0 * WING_LIFT)
    end = area.front + OVERHANG
    hip = min(half, (end - start) / 2.0) if wing.roof is Roof.HIP else 0.0
    low = (area.left - OVERHANG, builder.ground + bottom, start)
    high = (area.right + OVERHANG, builder.ground + bottom + EAVES + rise, end)
    return pitched_roof(Kind.ROOF, where, low, high, EAVES, (hip if wing.joint is None else 0.0, hip))


def _build_lean_to(builder: Builder, wing: Wing, top: float) -> Solid:
    """Build a lean-to roof against the wall of the main block."""
    where, area = _turned(builder.where, wing.outline, Side(wing.joint or 0).opposite)
    low = (area.left - OVERHANG, builder.ground + top, area.back + OUTER_WALL)
    high = (area.right + OVERHANG, builder.ground + top + LEAN_TO_RISE, area.front + OVERHANG)
    return lean_to(Kind.ROOF, where, low, high, EAVES)


def _build_exit(builder: Builder, stairs: Stairs, top: float) -> None:
    """Build walls and a roof around the top of the stairs, open behind the last step."""
    if stairs.landing:
        builder.block(Kind.WALL, stairs.spine, top, top + RAILING)
    outer = Rectangle(
        stairs.well.left - EDGE, stairs.well.back - EDGE, stairs.well.right + EDGE, stairs.well.front + EDGE
    )
    out = _side_of(stairs.well, stairs.exit)
    for side in Side:
        strip = strip_along(outer, side, EDGE)
        if side is not out:
            builder.block(Kind.WALL, strip, top, top + EXIT_HEIGHT)
            continue
        start, end = span_of(stairs.exit, side)
        for part in without([span_of(strip, side)], (start, end)):
            builder.block(Kind.WALL, part_of(strip, side, *part), top, top + EXIT_HEIGHT)
        builder.block(Kind.WALL, part_of(strip, side, start, end), top + DOOR_HEIGHT, top + EXIT_HEIGHT)
    builder.block(Kind.ROOF, outer, top + EXIT_HEIGHT, top + EXIT_HEIGHT + EDGE)


def _side_of(well: Rectangle, edge: Rectangle) -> Side:
    """Return on which side of a well an adjacent edge lies."""
    if edge.back >= well.front:
        return Side.FRONT
    if edge.front <= well.back:
        return Side.BACK
    return Side.RIGHT if edge.left >= well.right else Side.LEFT
