"""Drawing a random house plan from a seed."""

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.house.footprint import MAIN_LEAST, draw_wings
from wildscav_engine.maps.house.plan import HousePlan, Roof, Wing
from wildscav_engine.maps.house.room_purposes import STYLES
from wildscav_engine.maps.house.stairs import HallPlace, draw_stairs
from wildscav_engine.maps.house.storeys import can_be_joined, draw_storey

SMALLEST, LARGEST = MAIN_LEAST, 24.0  # m, range of the sides of a house
TRIES = 200  # attempts to place the stairs; one in three fails
ROOF_EXITS = 0.6  # share of the houses with a flat roof and space for stairs to it that have an exit there
ROOMY = 90.0  # m², least area of a house of one storey with space for stairs


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
        seed: Of the map.
        number: Number of the house, the key of its random numbers.
        storeys: Least and greatest number of storeys.
        small: Whether to draw a small house.
        area: Its size across and along in m; drawn if not given.

    Returns:
        The plan.

    Raises:
        MapError: A house cannot have this size.
    """
    if area and not all(SMALLEST <= side <= LARGEST for side in area):
        raise MapError(f"area is {area[0]} × {area[1]} m: a house takes {SMALLEST} to {LARGEST} m a side")
    dice = Dice(seed, Stream.HOUSES, agent=1000 + number)
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


def _draw_size(dice: Dice, small: bool) -> tuple[float, float]:
    """Draw the size in m across and along; large houses are rare."""
    if small:
        return dice.uniform(8.0, 9.5), dice.uniform(7.5, 8.5)
    across, along = dice.uniform(), dice.uniform()
    return 8.0 + 10.0 * across * across, 8.0 + 10.0 * along * along


def _place_stairs(dice: Dice, wings: tuple[Wing, ...]) -> HallPlace:
    """Draw a hall with stairs that leaves all parts of the house connected."""
    for _ in range(TRIES):
        place = draw_stairs(dice, wings[0].inside)
        if can_be_joined(dice, wings, place):
            return place
    raise RuntimeError("a house has no place for stairs")
