"""Memory for trained policies that gather: which boxes cannot be reached, and where to look for others.

A policy of one step remembers nothing. So it would stay at a box behind a wall for ever, and would not know
where it has looked already.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.policy import PolicyAgent
from wildscav.policy.supply_readings import way, with_boxes
from wildscav.skills.patience import Patience
from wildscav.skills.searching import Search

HOT_SPOT = "to_hot_spot"
FARTHEST = 4.5  # ln m, to which the way to a place of the search is said to be at most


class GatheringPolicyAgent(PolicyAgent):
    """Plays the policy in a folder, and hides from it the boxes that it could not reach lately.

    Where a match has no hot spot, the next place of a search along a spiral stands in for it, if the policy
    asks for ``to_hot_spot``.
    """

    def reset(self, match: MatchInfo) -> None:
        """Begin a match. See ``Agent.reset``."""
        super().reset(match)
        self.patience, self.search = Patience(match), Search(match)

    def act(self, observation: Observation) -> Action:
        """Return what the policy does. See ``Agent.act``."""
        boxes = self.patience.boxes(observation)
        readings = with_boxes(observation, boxes)
        if HOT_SPOT in readings and not self.knows_hot_spot(observation):
            readings[HOT_SPOT] = self.way_to_search(observation, len(readings[HOT_SPOT]))
        return super().act(replace(observation, supply_boxes=boxes, tensors=readings))

    @staticmethod
    def knows_hot_spot(observation: Observation) -> bool:
        """Return whether the match has a hot spot and the sensor ``to_hot_spot`` tells where."""
        reading = observation.tensors.get(HOT_SPOT)
        return reading is not None and bool(reading.any())

    def way_to_search(self, observation: Observation, numbers: int) -> NDArray[np.float32]:
        """Return a reading of ``to_hot_spot`` in which the hot spot is where the search goes on."""
        (x, _, z), (to_x, _, to_z) = observation.position, self.search.next_place(observation)
        right, ahead, log_distance = way(to_x - x, to_z - z, observation.yaw)
        reading = np.zeros(numbers, np.float32)
        reading[:4] = 1.0, right, ahead, min(log_distance, FARTHEST)
        return reading
