"""Drawing a random house plan from a seed."""

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.house.plan import (
    OUTER_WALL,
    HousePlan,
    Roof,
    Side,
    Wing,
    part_of,
    span_of,
    with_line,
)
from wildscav_engine.maps.house.stairs import HallPlace, draw_stairs
from wildscav_engine.maps.house.storeys import STYLES, can_be_joined, draw_storey
from wildscav_engine.specs.map_spec import Pieces

TRIES = 200  # attempts to place the stairs; one in three fails
ROOF_EXITS = 0.6  # share of the houses with a flat roof and space for stairs to it that have an exit there
ROOMY = 90.0  # m², least area of a house of one storey with space for stairs
MAIN_LEAST = 7.0  # m, least side of a main block: space for stairs and rooms beside them
SMALLEST, LARGEST = MAIN_LEAST, 24.0  # m, range of the sides of a house
WING_LEAST = 3.6  # m, least side
YARD_LEAST = 3.0  # m, beside a wing
# The roofs of each kind of wing, each with the random number below which it is drawn.
ROOFS = {
    "main": ((Roof.FLAT, 0.4), (Roof.GABLE, 0.75), (Roof.HIP, 1.0)),
    "lower": ((Roof.FLAT, 0.55), (Roof.GABLE, 0.8), (Roof.HIP, 1.0)),
    "annex": ((Roof.FLAT, 0.4), (Roof.LEAN_TO, 0.85), (Roof.GABLE, 1.0)),
}
TYPE_TRIES = 64  # plans drawn for a house until one is of a wanted type; two in five are unseen
NEXT_TRY = 100_000  # from the number of one plan to that of the next, beyond the numbers of all houses


def draw_plan(
    seed: int,
    number: int,
    storeys: tuple[int, int],
    *,
    small: bool = False,
    area: tuple[float, float] | None = None,
) -> HousePlan:
    """Draw one house of a map.

    Args:
        storeys: Least and greatest number of storeys.
        small: Whether to draw a small house.
        area: Its size across and along in m; drawn if not given.

    Raises:
        MapError: A house cannot have this size.
    """
    if area and not all(SMALLEST <= side <= LARGEST for side in area):
        raise MapError(f"area is {area[0]} × {area[1]} m: a house takes {SMALLEST} to {LARGEST} m a side")
    dice = RandomStream(seed, Stream.HOUSES, agent=1000 + number)
    size = area or _draw_size(dice, small)
    count = dice.integer(*storeys)
    style = STYLES[dice.integer(0, len(STYLES) - 1)]
    wings = draw_wings(dice, size, count)
    roomy = count > 1 or wings[0].outline.area >= ROOMY
    roof_exit = roomy and wings[0].roof is Roof.FLAT and dice.uniform() < ROOF_EXITS
    place = _place_stairs(dice, wings) if count > 1 or roof_exit else None
    drawn, terraces, doors = [], [], []
    for level in range(count):
        top = count if roof_exit else count - 1
        storey, found, outer = draw_storey(dice, wings, level, top, place, style)
        drawn.append(storey)
        terraces += found
        doors += outer
    stairs = place.stairs if place else None
    return HousePlan(size, style, wings, tuple(drawn), stairs, roof_exit, tuple(terraces), tuple(doors))


def _draw_size(dice: RandomStream, small: bool) -> tuple[float, float]:
    """Draw the size in m across and along; large houses are rare."""
    if small:
        return dice.uniform(8.0, 9.5), dice.uniform(7.5, 8.5)
    across, along = dice.uniform(), dice.uniform()
    return 8.0 + 10.0 * across * across, 8.0 + 10.0 * along * along


def _place_stairs(dice: RandomStream, wings: tuple[Wing, ...]) -> HallPlace:
    """Draw a hall with stairs that leaves all parts of the house connected."""
    for _ in range(TRIES):
        place = draw_stairs(dice, wings[0].inside)
        if can_be_joined(dice, wings, place):
            return place
    raise RuntimeError("a house has no place for stairs")


def draw_wings(dice: RandomStream, size: tuple[float, float], storeys: int) -> tuple[Wing, ...]:
    """Draw the one or two blocks of a house that fill a rectangle of a size in m, the main block first."""
    whole = Rectangle(-size[0] / 2.0, -size[1] / 2.0, size[0] / 2.0, size[1] / 2.0)
    main_roof = _draw_roof(dice, "main")
    shape = dice.uniform()
    sides = [side for side in Side if _has_room(size, side)]
    if shape < 0.3 or not sides:
        return (Wing(whole, storeys, None, main_roof),)
    side = sides[dice.integer(0, len(sides) - 1)]
    is_annex = shape < 0.62 and storeys > 1
    main, outline = _part(dice, whole, side, is_annex)
    if is_annex:
        return Wing(main, storeys, None, main_roof), Wing(
            outline, 1, side.opposite, _draw_roof(dice, "annex")
        )
    lower = storeys > 1 and dice.uniform() < 0.4
    roof = _draw_roof(dice, "lower") if lower else main_roof
    return Wing(main, storeys, None, main_roof), Wing(outline, storeys - lower, side.opposite, roof)


def _has_room(size: tuple[float, float], side: Side) -> bool:
    """Return whether a wing fits on a side of the main block."""
    beside, away = size if side.is_across else size[::-1]
    return away >= MAIN_LEAST + WING_LEAST - OUTER_WALL and beside >= max(WING_LEAST + YARD_LEAST, MAIN_LEAST)


def _part(dice: RandomStream, whole: Rectangle, side: Side, is_annex: bool) -> tuple[Rectangle, Rectangle]:
    """Return the outlines of the main block and of the wing on one side of it."""
    (start, end), (near, far) = span_of(whole, side), span_of(whole, side.aside)
    most = min(far - near - MAIN_LEAST, 5.0 if is_annex else 0.55 * (far - near))
    depth = dice.uniform(WING_LEAST - OUTER_WALL, most)
    widest = end - start - YARD_LEAST
    width = dice.uniform(min(widest, max(WING_LEAST, 0.35 * (end - start))), widest)
    place = dice.uniform()
    first = start if place < 0.4 else end - width
    if is_annex and place > 0.8:
        first = (start + end - width) / 2.0
    cut = far - depth if side.is_ahead else near + depth
    edge = cut - OUTER_WALL if side.is_ahead else cut + OUTER_WALL  # they share the wall between them
    wing = with_line(part_of(whole, side, first, first + width), side.opposite, edge)
    return with_line(whole, side, cut), wing


def _draw_roof(dice: RandomStream, kind: str) -> Roof:
    chance = dice.uniform()
    return next(roof for roof, below in ROOFS[kind] if chance < below)


def is_unseen(plan: HousePlan) -> bool:
    """Return whether a house is of a type that is kept for testing: an office, or under a hip roof."""
    return plan.style == "office" or plan.wings[0].roof is Roof.HIP


def draw_house(
    pieces: Pieces,
    seed: int,
    number: int,
    storeys: tuple[int, int],
    *,
    small: bool = False,
    area: tuple[float, float] | None = None,
) -> HousePlan:
    """Draw one house of a map, of one of the wanted types; see ``draw_plan``."""
    plan = draw_plan(seed, number, storeys, small=small, area=area)
    for attempt in range(1, TYPE_TRIES):
        if pieces == "all" or is_unseen(plan) == (pieces == "unseen"):
            break
        plan = draw_plan(seed, number + attempt * NEXT_TRY, storeys, small=small, area=area)
    return plan
