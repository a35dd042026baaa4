"""Houses made of convex solids, from their plans."""

from wildscav_engine.geometry.shapes import Pose, Rectangle, box, gable_roof
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.house_plan import (
    GOING,
    RISE,
    SLAB,
    STEPS,
    STOREY_HEIGHT,
    Flight,
    HousePlan,
    Wall,
)
from wildscav_engine.maps.sites import Site

FLOOR_LIFT = 0.08  # m of the ground floor above the levelled ground
FOUNDATION = 0.5  # m that the house reaches into the ground
PARAPET = 0.5  # m
EAVES, OVERHANG = 0.15, 0.4  # m
PITCH = 0.32  # height of a pitched roof by its width


class Builder:
    """Builds in the axes of one house."""

    def __init__(self, where: Pose, ground: float) -> None:
        """Start at a pose, with the ground floor at a height in m."""
        self.where = where
        self.ground = ground
        self.solids: list[Solid] = []

    def block(self, kind: Kind, area: Rectangle, bottom: float, top: float) -> None:
        """Add a box over a rectangle; heights in m count from the ground floor."""
        low = (area.left, self.ground + bottom, area.back)
        high = (area.right, self.ground + top, area.front)
        self.solids.append(box(kind, self.where, low, high))

    def wall(self, wall: Wall, floor: float, bottom: float, top: float) -> None:
        """Add a wall: pillars between its openings, lintels above and sills below them.

        Args:
            wall: The wall.
            floor: m, from where its openings count.
            bottom: m, where it starts.
            top: m, where it ends.
        """
        start, end = _ends(wall)
        for opening in wall.openings:
            left, right = opening.middle - opening.width / 2.0, opening.middle + opening.width / 2.0
            self.block(Kind.WALL, _part(wall, start, left), bottom, top)
            if floor + opening.bottom > bottom:
                sill = Kind.FLOOR if opening.is_doorway else Kind.WALL
                self.block(sill, _part(wall, left, right), bottom, floor + opening.bottom)
            self.block(Kind.WALL, _part(wall, left, right), floor + opening.top, top)
            start = right
        self.block(Kind.WALL, _part(wall, start, end), bottom, top)

    def slab(self, kind: Kind, area: Rectangle, hole: Rectangle | None, bottom: float, top: float) -> None:
        """Add a floor with a rectangular hole."""
        for part in around_hole(area, hole):
            self.block(kind, part, bottom, top)

    def stairs(self, flight: Flight, floor: float) -> None:
        """Add a flight of solid steps."""
        left, back, right, front = flight.outline
        for step in range(STEPS - 1):
            near = back + step * GOING if flight.climb > 0 else front - (step + 1) * GOING
            area = Rectangle(left, near, right, near + GOING)
            self.block(Kind.STAIR, area, floor, floor + (step + 1) * RISE)


def _ends(wall: Wall) -> tuple[float, float]:
    outline = wall.outline
    return (outline.left, outline.right) if wall.is_across else (outline.back, outline.front)


def _part(wall: Wall, start: float, end: float) -> Rectangle:
    """Return the part of a wall's outline between two places on the axis it runs on."""
    if wall.is_across:
        return wall.outline._replace(left=start, right=end)
    return wall.outline._replace(back=start, front=end)


def around_hole(area: Rectangle, hole: Rectangle | None) -> list[Rectangle]:
    """Return rectangles that cover an area but not the hole in it."""
    if hole is None:
        return [area]
    parts = [
        area._replace(front=hole.back),
        area._replace(back=hole.front),
        Rectangle(area.left, hole.back, hole.left, hole.front),
        Rectangle(hole.right, hole.back, area.right, hole.front),
    ]
    return [part for part in parts if part.right > part.left and part.front > part.back]


def build_house(plan: HousePlan, site: Site) -> list[Solid]:
    """Return all solids of a house."""
    builder = Builder(site.pose, site.ground + FLOOR_LIFT)
    for level, storey in enumerate(plan.storeys):
        floor = level * STOREY_HEIGHT
        below = FOUNDATION if level == 0 else 0.0
        for wall in storey.outer:
            builder.wall(wall, floor, floor - below, floor + STOREY_HEIGHT)
        for wall in storey.inner:
            builder.wall(wall, floor, floor, floor + STOREY_HEIGHT - SLAB)
        thickness = FOUNDATION if level == 0 else SLAB
        builder.slab(Kind.FLOOR, plan.room, storey.hole, floor - thickness, floor)
        if storey.flight:
            builder.stairs(storey.flight, floor)
    _build_roof(builder, plan)
    return builder.solids


def _build_roof(builder: Builder, plan: HousePlan) -> None:
    top = len(plan.storeys) * STOREY_HEIGHT
    builder.block(Kind.FLOOR if plan.gable else Kind.ROOF, plan.room, top - SLAB, top)
    if not plan.gable:
        for wall in plan.storeys[-1].outer:
            builder.block(Kind.ROOF, wall.outline, top, top + PARAPET)
        return
    where, (across, along) = builder.where, plan.size
    if across > along:  # the ridge runs the longer way
        where, across, along = where._replace(sine=where.cosine, cosine=-where.sine), along, across
    half_across, half_along = across / 2.0 + OVERHANG, along / 2.0 + OVERHANG
    eaves = builder.ground + top
    low = (-half_across, eaves, -half_along)
    high = (half_across, eaves + EAVES + PITCH * across, half_along)
    builder.solids.append(gable_roof(Kind.ROOF, where, low, high, EAVES))


def doorsteps(plan: HousePlan, site: Site, distance: float) -> list[tuple[float, float]]:
    """Return x and z of the places in m in front of each outer doorway, this far from the wall."""
    places = []
    front, back = plan.storeys[0].outer[:2]
    for wall, outwards in ((front, 1.0), (back, -1.0)):
        along = outwards * (plan.size[1] / 2.0 + distance)
        places += [site.pose.outside(door.middle, along) for door in wall.openings if door.is_doorway]
    return places
