"""Boxes, walls, floors and stairs in the axes of one house."""

from wildscav_engine.geometry.shapes import Pose, Rectangle, boxes
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.house.plan import DOOR_HEIGHT, SLAB, WINDOW_SILL, Stairs, Wall
from wildscav_engine.maps.house.stairs import LANDING_HEIGHT, steps_of

STEP_THICKNESS = 0.4  # m, of steps that hang over the stairs below
RAILING = 1.0  # m, height


class Builder:
    """Collects the boxes of one house, to make all of them at once."""

    def __init__(self, where: Pose, ground: float) -> None:
        """Start at a pose, with the ground floor at a height in m."""
        self.where = where
        self.ground = ground
        self._kinds: list[Kind] = []
        self._corners: list[tuple[float, ...]] = []

    def block(self, kind: Kind, area: Rectangle, bottom: float, top: float) -> None:
        """Add a box over a rectangle; heights in m count from the ground floor."""
        self._kinds.append(kind)
        low, high = self.ground + bottom, self.ground + top
        self._corners.append((area.left, low, area.back, area.right, high, area.front))

    def solids(self) -> list[Solid]:
        """Make the boxes."""
        return boxes(self._kinds, self.where, self._corners)

    def wall(self, wall: Wall, floor: float, bottom: float, top: float) -> None:
        """Add a wall: one lintel over all its openings, pillars between them, sills under windows.

        Args:
            wall: The wall.
            floor: m, from where its openings count.
            bottom: m, where it starts.
            top: m, where it ends.
        """
        if not wall.openings:
            self.block(Kind.WALL, wall.outline, bottom, top)
            return
        sill, lintel = floor + WINDOW_SILL, floor + DOOR_HEIGHT
        self.block(Kind.WALL, wall.outline, lintel, top)
        start, end = _ends(wall)
        # A sill runs from doorway to doorway, and the pillars between windows stand on it.
        sill_start, pillar_start = start, start
        has_window = False
        for opening in wall.openings:
            if opening.is_doorway:
                self._between(wall, sill_start, pillar_start, opening.start, has_window, bottom, sill, lintel)
                if bottom < floor:
                    self.block(Kind.FLOOR, part_of(wall, opening.start, opening.end), bottom, floor)
                sill_start, has_window = opening.end, False
            else:
                self.block(Kind.WALL, part_of(wall, pillar_start, opening.start), sill, lintel)
                has_window = True
            pillar_start = opening.end
        self._between(wall, sill_start, pillar_start, end, has_window, bottom, sill, lintel)

    def _between(
        self,
        wall: Wall,
        sill_start: float,
        pillar_start: float,
        end: float,
        has_window: bool,
        bottom: float,
        sill: float,
        lintel: float,
    ) -> None:
        """Add the part of a wall that ends at a doorway or corner: its last pillar, and the sill under it."""
        if has_window:
            self.block(Kind.WALL, part_of(wall, sill_start, end), bottom, sill)
            self.block(Kind.WALL, part_of(wall, pillar_start, end), sill, lintel)
        elif end > sill_start:
            self.block(Kind.WALL, part_of(wall, sill_start, end), bottom, lintel)

    def floor(self, area: Rectangle, hole: Rectangle | None, bottom: float, top: float) -> None:
        """Add a floor with a rectangular hole."""
        for part in around_hole(area, hole):
            self.block(Kind.FLOOR, part, bottom, top)

    def stairs(self, stairs: Stairs, floor: float, *, hangs: bool) -> None:
        """Add the stairs from a floor to the next.

        Args:
            stairs: The stairs.
            floor: m, where they start.
            hangs: Whether there are stairs below, that need room; else they stand on the floor.
        """
        for flight in stairs.flights:
            for area, height in steps_of(flight):
                bottom = floor + (height - STEP_THICKNESS if hangs else 0.0)
                self.block(Kind.STAIR, area, bottom, floor + height)
        if stairs.landing:
            bottom = floor + (LANDING_HEIGHT - SLAB if hangs else 0.0)
            self.block(Kind.STAIR, stairs.landing, bottom, floor + LANDING_HEIGHT)


def _ends(wall: Wall) -> tuple[float, float]:
    outline = wall.outline
    return (outline.left, outline.right) if wall.is_across else (outline.back, outline.front)


def part_of(wall: Wall, start: float, end: float) -> Rectangle:
    """Return the part of a wall's outline between two places on the axis that it runs on."""
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
    return [part for part in parts if part.right - part.left > 1e-6 and part.front - part.back > 1e-6]
