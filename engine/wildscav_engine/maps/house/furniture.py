"""Furnishing rooms according to their purpose.

Pieces stand in strips along the walls, or in the middle. The space between the strips is wide enough to walk,
and so is the passage to it from every doorway, so furniture never cuts a room in two.
"""

from collections.abc import Callable
from typing import NamedTuple

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import (
    PASSAGE_WIDTH,
    TOUCHING,
    WINDOW_SILL,
    Block,
    Furniture,
    Side,
    line_of,
    part_of,
    shrunk,
    span_of,
    strip_at,
    with_line,
)
from wildscav_engine.maps.house.rooms import Span, without

Box = tuple[float, float, float, float, float, float]  # m: left, from the wall, bottom; right, to, top
CORNER_GAP = 0.05  # m between pieces side by side
PIECES_OF_LARGE_ROOM = 20.0  # m², above which a room has one piece more


class Gap(NamedTuple):
    """A doorway or window, seen from a room."""

    side: Side
    span: Span  # m
    is_doorway: bool


class Piece(NamedTuple):
    """A type of furniture, seen from its front."""

    widths: tuple[float, float]  # m, least and most
    depth: float  # m
    height: float  # m
    parts: Callable[[float], tuple[Box, ...]] | None = None  # a function of its width; None: one box
    in_middle: bool = False  # whether it preferably stands in the middle of a room

    def boxes(self, width: float) -> tuple[Box, ...]:
        """Return its boxes at a width in m."""
        return self.parts(width) if self.parts else ((0.0, 0.0, 0.0, width, self.depth, self.height),)


PIECES: dict[str, Piece] = {
    "bed": Piece(
        (1.2, 1.8), 2.1, 0.95, lambda w: ((0.0, 0.0, 0.0, w, 0.12, 0.95), (0.0, 0.12, 0.0, w, 2.1, 0.5))
    ),
    "cot": Piece(
        (1.9, 2.1), 0.95, 0.85, lambda w: ((0.0, 0.0, 0.0, 0.12, 0.95, 0.85), (0.12, 0.0, 0.0, w, 0.95, 0.48))
    ),
    "wardrobe": Piece((1.2, 2.2), 0.6, 2.05),
    "shelf": Piece((1.0, 2.4), 0.4, 1.9),
    "chest": Piece((0.9, 1.4), 0.5, 0.85),
    "sofa": Piece(
        (1.6, 2.4), 0.9, 0.85, lambda w: ((0.0, 0.0, 0.0, w, 0.3, 0.85), (0.0, 0.3, 0.0, w, 0.9, 0.42))
    ),
    "counter": Piece((1.8, 3.2), 0.62, 0.92),
    "fridge": Piece((0.7, 0.8), 0.7, 1.85),
    "desk": Piece(
        (1.3, 1.7), 0.75, 0.75, lambda w: ((0.0, 0.0, 0.68, w, 0.75, 0.75), (0.0, 0.0, 0.0, 0.5, 0.75, 0.68))
    ),
    "tub": Piece((1.6, 1.8), 0.8, 0.58),
    "basin": Piece((0.6, 0.9), 0.5, 0.85),
    "crates": Piece(
        (1.1, 1.9), 0.95, 1.65, lambda w: ((0.0, 0.0, 0.0, w, 0.95, 0.9), (0.1, 0.1, 0.9, 0.9, 0.85, 1.65))
    ),
    "crate": Piece((0.8, 1.1), 0.85, 0.9),
    "table": Piece(
        (1.5, 2.2),
        0.95,
        0.75,
        lambda w: ((0.0, 0.0, 0.68, w, 0.95, 0.75), (0.3, 0.25, 0.0, w - 0.3, 0.7, 0.68)),
        in_middle=True,
    ),
    "rack": Piece((2.0, 3.2), 0.8, 2.0, in_middle=True),
    "island": Piece((1.6, 2.2), 0.8, 0.92, in_middle=True),
}

# The smaller piece to use where another one does not fit.
SUBSTITUTES = {"bed": "cot", "sofa": "chest", "counter": "basin", "tub": "shelf"}

# The pieces of a room by its purpose, the most important first.
ROOMS: dict[str, tuple[str, ...]] = {
    "living": ("sofa", "table", "shelf", "chest"),
    "dining": ("table", "chest", "shelf"),
    "kitchen": ("counter", "fridge", "island", "table"),
    "bedroom": ("bed", "wardrobe", "chest", "desk"),
    "study": ("desk", "shelf", "sofa", "shelf"),
    "bath": ("tub", "basin"),
    "pantry": ("shelf", "crate", "shelf"),
    "store": ("crates", "rack", "shelf", "crates", "crate"),
    "workshop": ("counter", "crates", "table", "shelf"),
    "office": ("desk", "shelf", "table", "chest"),
    "hall": ("chest", "sofa", "shelf"),
    "corridor": (),
}


class _Arrangement:
    """The furniture of a room so far, and the space that must stay free."""

    def __init__(self, area: Rectangle, gaps: list[Gap]) -> None:
        self.area, self.gaps = area, gaps
        self.core = area  # between the pieces at the walls
        self.kept: Rectangle | None = None  # of the core, around a piece in the middle
        self.outlines: list[Rectangle] = []

    def leaves_passage(self, side: Side, depth: float) -> bool:
        """Return whether a piece of a depth at a wall leaves a passage between it and the opposite side."""
        left, back, right, front = self.core
        taken = abs(line_of(self.area, side) - line_of(self.core, side))
        across = front - back if side.is_across else right - left
        return across - max(0.0, depth - taken) >= PASSAGE_WIDTH

    def place_at_wall(self, outline: Rectangle, side: Side) -> bool:
        """Place a piece at a wall if all passages stay free; return whether it was placed."""
        core = _less(self.core, outline, side)
        if min(core.right - core.left, core.front - core.back) < PASSAGE_WIDTH:
            return False
        if self.kept and not _contains(core, self.kept):
            return False
        outlines = [*self.outlines, outline]
        for gap in self.gaps:
            if gap.is_doorway:
                passage = _doorway_clearance(self.area, core, gap)
                if any(overlap(passage, other) for other in outlines):
                    return False
        self.core, self.outlines = core, outlines
        return True

    def place_in_middle(self, outline: Rectangle) -> bool:
        """Place a piece in the middle if there is a passage all around it; return whether it was placed."""
        kept = shrunk(outline, -PASSAGE_WIDTH)
        if self.kept or not _contains(self.core, kept):
            return False
        self.kept = kept
        self.outlines.append(outline)
        return True

    def free_spans(self, side: Side, piece: Piece) -> list[Span]:
        """Return the parts of a wall that are free for a piece."""
        spans = [span_of(self.area, side)]
        for gap in self.gaps:
            if gap.side is side and (gap.is_doorway or piece.height > WINDOW_SILL):
                spans = without(spans, gap.span)
        strip = strip_at(self.area, side, piece.depth + CORNER_GAP)
        for outline in self.outlines:
            if overlap(strip, outline):
                start, end = span_of(outline, side)
                spans = without(spans, (start - CORNER_GAP, end + CORNER_GAP))
        return spans


def furnish(
    dice: RandomStream, area: Rectangle, purpose: str, gaps: list[Gap], sides: tuple[Side, ...]
) -> list[Furniture]:
    """Furnish an area of a room with up to four pieces, at some of its walls and in its middle."""
    most = (purpose != "hall") + 1 + (area.area > 12.0) + (area.area > PIECES_OF_LARGE_ROOM)
    arrangement = _Arrangement(area, gaps)
    placed: list[Furniture] = []
    for name in ROOMS[purpose]:
        if len(placed) == most:
            break
        found = _place_piece(dice, arrangement, name, sides)
        if not found and name in SUBSTITUTES:
            found = _place_piece(dice, arrangement, SUBSTITUTES[name], sides)
        if found:
            placed.append(found)
    return placed


def _place_piece(
    dice: RandomStream, arrangement: _Arrangement, name: str, sides: tuple[Side, ...]
) -> Furniture | None:
    """Place a piece in a room and return it, or None if it does not fit."""
    piece = PIECES[name]
    width = dice.uniform(*piece.widths)
    if piece.in_middle:
        outline, side = _in_middle(dice, arrangement.core, piece, width)
        if arrangement.place_in_middle(outline):
            return _furniture(name, outline, side, width)
    for _, side in sorted((dice.uniform(), side) for side in sides):
        if not arrangement.leaves_passage(side, piece.depth):
            continue
        span = _draw_place(dice, arrangement.free_spans(side, piece), width)
        if span is None:
            continue
        outline = part_of(strip_at(arrangement.area, side, piece.depth), side, *span)
        if arrangement.place_at_wall(outline, side):
            return _furniture(name, outline, side, width)
    return None


def _draw_place(dice: RandomStream, spans: list[Span], width: float) -> Span | None:
    """Draw the place of a piece along a wall, preferably in a corner."""
    wide = [span for span in spans if span[1] - span[0] >= width]
    if not wide:
        return None
    start, end = wide[dice.integer(0, len(wide) - 1)]
    place = dice.uniform()
    first = start if place < 0.4 else end - width if place > 0.6 else start + (end - start - width) / 2.0
    return first, first + width


def _in_middle(dice: RandomStream, core: Rectangle, piece: Piece, width: float) -> tuple[Rectangle, Side]:
    """Return the outline of a piece in the middle of a room, aligned with the room, and its back side."""
    across, along = (core.left + core.right) / 2.0, (core.back + core.front) / 2.0
    lies_across = core.right - core.left >= core.front - core.back
    half = (width / 2.0, piece.depth / 2.0)
    half_across, half_along = half if lies_across else half[::-1]
    outline = Rectangle(across - half_across, along - half_along, across + half_across, along + half_along)
    turned = dice.uniform() < 0.5
    if lies_across:
        return outline, Side.FRONT if turned else Side.BACK
    return outline, Side.RIGHT if turned else Side.LEFT


def overlap(one: Rectangle, other: Rectangle) -> bool:
    """Return whether two rectangles share more than an edge."""
    return (
        one.left < other.right - TOUCHING
        and other.left < one.right - TOUCHING
        and one.back < other.front - TOUCHING
        and other.back < one.front - TOUCHING
    )


def _contains(outer: Rectangle, inner: Rectangle) -> bool:
    return (
        outer.left <= inner.left
        and outer.back <= inner.back
        and outer.right >= inner.right
        and outer.front >= inner.front
    )


def _less(core: Rectangle, outline: Rectangle, side: Side) -> Rectangle:
    """Return the part of a room's middle that a piece at a wall leaves free."""
    lines = line_of(core, side), line_of(outline, side.opposite)
    return with_line(core, side, min(lines) if side.is_ahead else max(lines))


def _doorway_clearance(area: Rectangle, core: Rectangle, gap: Gap) -> Rectangle:
    """Return the area that must stay free in front of a doorway, so that the middle can be reached."""
    depth = abs(line_of(area, gap.side) - line_of(core, gap.side)) + PASSAGE_WIDTH
    return part_of(strip_at(area, gap.side, depth), gap.side, *gap.span)


def _furniture(name: str, outline: Rectangle, side: Side, width: float) -> Furniture:
    """Return a piece with its boxes and its back towards a side."""
    blocks = []
    start = span_of(outline, side)[0]
    for left, near, bottom, right, far, top in PIECES[name].boxes(width):
        block = part_of(strip_at(outline, side, far), side, start + left, start + right)
        blocks.append(Block(_less(block, strip_at(outline, side, near), side), bottom, top))
    return Furniture(name, outline, tuple(blocks))
