"""What sensors of supplies would read if only some boxes were there, for agents that leave others alone."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Observation, SupplyBox, Vector
from wildscav.policy.elementary_functions import cosine, logarithm, sine

CLIMB = 4.0  # m of level walking that take as long as a metre of height
WORTH, START_UP = 0.6, 3.0  # the default options of ``to_supplies``


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
