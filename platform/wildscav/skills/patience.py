"""Leaving boxes alone that cannot be reached: behind walls, or on another storey."""

from wildscav.agent import MatchInfo, Observation, SupplyBox
from wildscav.geometry import flat_distance

NEAR = 7.0  # m
PATIENCE = 3.0  # s near a box, in all, after which it is left alone
LEFT_ALONE = 30.0  # s


class Patience:
    """Counts how long each box has been near without being picked up."""

    def __init__(self, match: MatchInfo) -> None:
        self._step_time = match.step_time
        self._near: dict[int, float] = {}  # s, by box
        self._left_alone: dict[int, float] = {}  # s of game time when it may be tried again, by box

    def boxes(self, observation: Observation) -> tuple[SupplyBox, ...]:
        """Return the boxes in sight that are worth trying; to be called at every step."""
        now = observation.time
        for box in observation.supply_boxes:
            if flat_distance(observation.position, box.position) < NEAR:
                self._near[box.id] = self._near.get(box.id, 0.0) + self._step_time
                if self._near[box.id] > PATIENCE:
                    self._near[box.id], self._left_alone[box.id] = 0.0, now + LEFT_ALONE
        return tuple(box for box in observation.supply_boxes if self._left_alone.get(box.id, 0.0) <= now)
