"""One house on level ground, for tests of houses."""

import numpy as np

from wildscav_engine.geometry.shapes import pose
from wildscav_engine.geometry.world import build_world
from wildscav_engine.maps.house import FLOOR_LIFT, STOREY_HEIGHT, HousePlan, build_house
from wildscav_engine.maps.settlements.sites import Site

CELLS = 32


class BuiltHouse:
    """A house in the middle of 64 × 64 m of level ground."""

    def __init__(self, plan: HousePlan, yaw: float = 0.0) -> None:
        self.plan = plan
        self.site = Site(pose(3.0, -2.0, yaw), yaw, plan.size, 0.0)
        self.solids = build_house(plan, self.site)
        self.world = build_world(
            (-float(CELLS), -float(CELLS)),
            np.zeros((CELLS + 1, CELLS + 1)),
            np.full((CELLS, CELLS), -np.inf),
            self.solids,
            np.zeros((0, 3)),
        )

    def height(self, level: int) -> float:
        """Return the height of a floor in m."""
        return FLOOR_LIFT + level * STOREY_HEIGHT
