"""Building boxes, walls, floors and stairs in the axes of one house."""

from wildscav_engine.geometry.shapes import Pose, Rectangle, boxes
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.house.plan import (
    DOOR_HEIGHT,
    SLAB,
    TOUCHING,
    WINDOW_SILL,
    Side,
    Stairs,
    Wall,
    span_of,
)
from wildscav_engine.maps.house.rooms import without
from wildscav_engine.maps.house.stairs import LANDING_HEIGHT, steps_of

STEP_THICKNESS = 0.1  # m, of steps above other stairs: thin treads leave more headroom below
RAILING = 1.0  # m, height


class Builder:
    """Collects the boxes of one house and builds all of them at once."""

    def __init__(self, where: Pose, ground: float) -> None:
        """Start at a pose, with the ground floor at a height in m."""
        self.where = where
        self.ground = ground
        self._kinds: list[Kind] = []
        self._corners: list[tuple[float, ...]] = []

    def block(self, kind: Kind, area: Rectangle, bottom: float, top: float) -> None:
        """Add a box over a rectangle, unless it is only as thick as a rounding error.

        Args:
            area: Its horizontal extent.
            bottom: m above the ground floor.
            top: m above the ground floor.
        """
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

        Args:
            floor: m, the height that its openings refer to.
            bottom: m, its bottom.
            top: m, its top.
        """
        ends = [span_of(wall.outline, Side.FRONT if wall.is_across else Side.RIGHT)]
        if not wall.openings:
            self.block(Kind.WALL, wall.outline, bottom, top)
            return
        sill, lintel = floor + WINDOW_SILL, floor + DOOR_HEIGHT
        self.block(Kind.WALL, wall.outline, lintel, top)
        for door in wall.doorways:
            ends = without(ends, (door.start, door.end))
            if bottom < floor:
                self.block(Kind.FLOOR, part_of(wall, door.start, door.end), bottom, floor)
        for start, end in ends:
            windows = [other for other in wall.openings if start < other.middle < end]
            self.block(Kind.WALL, part_of(wall, start, end), bottom, sill if windows else lintel)
            pillars = [(start, end)] if windows else []
            for window in windows:
                pillars = without(pillars, (window.start, window.end))
            for pillar in pillars:
                self.block(Kind.WALL, part_of(wall, *pillar), sill, lintel)

    def floor(self, area: Rectangle, hole: Rectangle | None, bottom: float, top: float) -> None:
        """Add a floor with a rectangular hole."""
        for part in around_hole(area, hole):
            self.block(Kind.FLOOR, part, bottom, top)

    def stairs(self, stairs: Stairs, floor: float, *, hangs: bool) -> None:
        """Add the stairs from a floor to the next.

        Args:
            floor: m, the height where they start.
            hangs: Whether there are other stairs below, which need headroom; else the stairs stand on the
                floor.
        """
        for flight in stairs.flights:
            for area, height in steps_of(flight):
                bottom = floor + (height - STEP_THICKNESS if hangs else 0.0)
                self.block(Kind.STAIR, area, bottom, floor + height)
        if stairs.landing:
            bottom = floor + (LANDING_HEIGHT - SLAB if hangs else 0.0)
            self.block(Kind.STAIR, stairs.landing, bottom, floor + LANDING_HEIGHT)


def part_of(wall: Wall, start: float, end: float) -> Rectangle:
    """Return the part of a wall's outline between two coordinates on the axis that it runs along."""
    if wall.is_across:
        return wall.outline._replace(left=start, right=end)
    return wall.outline._replace(back=start, front=end)


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
