"""Drawing the outlines of houses: a block, a block with a wing (an L), or a block with a low annex."""

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import OUTER_WALL, Roof, Side, Wing

MAIN_LEAST = 7.0  # m, least side of a main block: space for stairs and rooms beside them
WING_LEAST = 3.6  # m, least side
YARD_LEAST = 3.0  # m, beside a wing


def draw_wings(dice: Dice, size: tuple[float, float], storeys: int) -> tuple[Wing, ...]:
    """Draw the blocks of a house that fill a rectangle of a size in m, the main block first.

    Args:
        dice: The source of randomness.
        size: Across and along.
        storeys: Of the main block.

    Returns:
        One or two wings.
    """
    whole = Rectangle(-size[0] / 2.0, -size[1] / 2.0, size[0] / 2.0, size[1] / 2.0)
    main_roof = _draw_main_roof(dice)
    shape = dice.uniform()
    sides = [side for side in Side if _has_room(size, side)]
    if shape < 0.3 or not sides:
        return (Wing(whole, storeys, None, main_roof),)
    side = sides[dice.integer(0, len(sides) - 1)]
    is_annex = shape < 0.62 and storeys > 1
    main, outline = _part(dice, whole, side, is_annex)
    if is_annex:
        return Wing(main, storeys, None, main_roof), Wing(outline, 1, side.opposite, _draw_annex_roof(dice))
    lower = storeys > 1 and dice.uniform() < 0.4
    roof = _draw_low_roof(dice) if lower else main_roof
    return Wing(main, storeys, None, main_roof), Wing(outline, storeys - lower, side.opposite, roof)


def _has_room(size: tuple[float, float], side: Side) -> bool:
    """Return whether a wing fits on a side of the main block."""
    beside, away = size if side.is_across else size[::-1]
    return away >= MAIN_LEAST + WING_LEAST - OUTER_WALL and beside >= max(WING_LEAST + YARD_LEAST, MAIN_LEAST)


def _part(dice: Dice, whole: Rectangle, side: Side, is_annex: bool) -> tuple[Rectangle, Rectangle]:
    """Return the outlines of the main block and of the wing on one side of it."""
    start, end = (whole.left, whole.right) if side.is_across else (whole.back, whole.front)
    near, far = (whole.back, whole.front) if side.is_across else (whole.left, whole.right)
    most = min(far - near - MAIN_LEAST, 5.0 if is_annex else 0.55 * (far - near))
    depth = dice.uniform(WING_LEAST - OUTER_WALL, most)
    widest = end - start - YARD_LEAST
    width = dice.uniform(min(widest, max(WING_LEAST, 0.35 * (end - start))), widest)
    place = dice.uniform()
    first = start if place < 0.4 else end - width
    if is_annex and place > 0.8:
        first = (start + end - width) / 2.0
    ahead = side in (Side.FRONT, Side.RIGHT)
    cut = far - depth if ahead else near + depth
    main = (start, near, end, cut) if ahead else (start, cut, end, far)
    wing = (
        (first, cut - OUTER_WALL, first + width, far)
        if ahead
        else (first, near, first + width, cut + OUTER_WALL)
    )
    if side.is_across:
        return Rectangle(*main), Rectangle(*wing)
    return Rectangle(main[1], main[0], main[3], main[2]), Rectangle(wing[1], wing[0], wing[3], wing[2])


def _draw_main_roof(dice: Dice) -> Roof:
    chance = dice.uniform()
    return Roof.FLAT if chance < 0.4 else Roof.GABLE if chance < 0.75 else Roof.HIP


def _draw_low_roof(dice: Dice) -> Roof:
    chance = dice.uniform()
    return Roof.FLAT if chance < 0.55 else Roof.GABLE if chance < 0.8 else Roof.HIP


def _draw_annex_roof(dice: Dice) -> Roof:
    chance = dice.uniform()
    return Roof.FLAT if chance < 0.4 else Roof.LEAN_TO if chance < 0.85 else Roof.GABLE
