"""Types of houses: those that maps for training hold, and those that are kept for testing."""

from wildscav_engine.maps.house.plan import HousePlan, Roof
from wildscav_engine.maps.house.random_plan import draw_plan
from wildscav_engine.specs.map_spec import Pieces

TRIES = 64  # plans drawn for a house until one is of a wanted type; two in five are unseen
NEXT_TRY = 100_000  # from the number of one plan to that of the next, beyond the numbers of all houses


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
    for attempt in range(1, TRIES):
        if pieces == "all" or is_unseen(plan) == (pieces == "unseen"):
            break
        plan = draw_plan(seed, number + attempt * NEXT_TRY, storeys, small=small, area=area)
    return plan
