"""Houses: drawing a plan from a seed, and building solids from a plan."""

from wildscav_engine.maps.house.build import FLOOR_LIFT, build_house, doorsteps, house_of
from wildscav_engine.maps.house.plan import (
    DOOR_HEIGHT,
    DOOR_WIDTH,
    STOREY_HEIGHT,
    HousePlan,
    Opening,
    Side,
    Storey,
    Wall,
)
from wildscav_engine.maps.house.random_plan import LARGEST, SMALLEST, draw_house, draw_plan, is_unseen

__all__ = [
    "DOOR_HEIGHT",
    "DOOR_WIDTH",
    "FLOOR_LIFT",
    "LARGEST",
    "SMALLEST",
    "STOREY_HEIGHT",
    "HousePlan",
    "Opening",
    "Side",
    "Storey",
    "Wall",
    "build_house",
    "doorsteps",
    "draw_house",
    "draw_plan",
    "house_of",
    "is_unseen",
]
