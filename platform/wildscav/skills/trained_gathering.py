"""Memory for trained policies that gather: which boxes cannot be reached, and where to look for others.

A policy of one step remembers nothing. So it would stay at a box behind a wall for ever, and would not know
where it has looked already.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Action, MatchInfo, Observation, SupplyBox, Vector
from wildscav.policy import PolicyAgent
from wildscav.policy.elementary_functions import cosine, logarithm, sine
from wildscav.skills.patience import Patience
from wildscav.skills.searching import Search

HOT_SPOT = "to_hot_spot"
FARTHEST = 4.5  # ln m, to which the way to a place of the search is said to be at most
CLIMB = 4.0  # m of level walking that take as long as a metre of height
WORTH, START_UP = 0.6, 3.0  # the default options of ``to_supplies``


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


def with_boxes(seen: Observation, boxes: Sequence[SupplyBox]) -> dict[str, NDArray[Any]]:
    """Return an observation's sensor readings as if only some of its boxes were there.

    Args:
        seen: The observation. Of its readings, ``nearby_supplies`` and ``to_supplies`` change, the latter at
            its default ``worth`` and ``start_up``.
        boxes: Some of its boxes, in the same order.
    """
    readings: Mapping[str, NDArray[Any]] = seen.tensors
    rows = {
        "nearby_supplies": [nearby_row(seen, box) for box in boxes],
        "to_supplies": [way_row(seen, box) for box in sorted(boxes, key=lambda box: cost_of(seen, box))],
    }
    changed = {name: _filled(readings[name], wanted) for name, wanted in rows.items() if name in readings}
    return {**readings, **changed}


def nearby_row(seen: Observation, box: SupplyBox) -> tuple[float, ...]:
    """Return what ``nearby_supplies`` reads of a box."""
    x, y, z = _offset(seen, box)
    return 1.0, box.quantity, x, y, z, math.sqrt(x * x + y * y + z * z)


def way_row(seen: Observation, box: SupplyBox) -> tuple[float, ...]:
    """Return what ``to_supplies`` reads of a box."""
    x, y, z = _offset(seen, box)
    right, ahead, log_distance = way(x, z, seen.yaw)
    return 1.0, right, ahead, y, log_distance, logarithm(1.0 + box.quantity)


def cost_of(seen: Observation, box: SupplyBox) -> float:
    """Return the logarithm of the effort to fetch a box relative to its worth; see ``to_supplies``."""
    x, y, z = _offset(seen, box)
    effort = START_UP + math.sqrt(x * x + z * z) + CLIMB * abs(y)
    return logarithm(effort) - WORTH * logarithm(float(box.quantity))


def way(east: float, north: float, yaw: float) -> tuple[float, float, float]:
    """Return a way's parts to the right of a yaw and along it, of 1, and ln(1 + its length / m)."""
    distance = math.sqrt(east * east + north * north)
    if distance == 0.0:
        return 0.0, 0.0, 0.0
    right = (east * cosine(yaw) - north * sine(yaw)) / distance
    ahead = (east * sine(yaw) + north * cosine(yaw)) / distance
    return max(-1.0, min(1.0, right)), max(-1.0, min(1.0, ahead)), logarithm(1.0 + distance)


def _offset(seen: Observation, box: SupplyBox) -> Vector:
    """Return where a box is from the agent's soles, m."""
    (x, y, z), (to_x, to_y, to_z) = seen.position, box.position
    return to_x - x, to_y - y, to_z - z


def _filled(reading: NDArray[Any], rows: Sequence[tuple[float, ...]]) -> NDArray[Any]:
    """Return an array like a reading, with these rows first and zeros after them."""
    filled = np.zeros_like(reading)
    shown = rows[: len(filled)]
    filled[: len(shown)] = np.array(shown, np.float64).reshape(len(shown), reading.shape[1])
    return filled
