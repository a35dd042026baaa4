"""Flat observations: one row of numbers, each divided by a typical scale."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict
from numpy.typing import NDArray

from wildscav_engine.envs.spaces.columns import LOG_DISTANCE, SHARE, groups_of

# The divisors of numbers by their unit. Sensor readings are divided by the bound of their space, or by 100 if
# that is larger than LARGEST_BOUND.
SCALES = {
    "m": 100.0,
    "m/s": 10.0,
    "degrees": 180.0,
    "s": 100.0,
    "hp": 100.0,
    "0 or 1": 1.0,
    SHARE: 1.0,
    LOG_DISTANCE: 5.0,
}
COUNT, LARGEST_BOUND = 10.0, 2000.0


class Flattener:
    """Converts observations to rows of numbers."""

    def __init__(self, space: Dict, version: int = 0) -> None:
        """Create a flattener.

        Args:
            space: The observation space of one learner, a Dict of Boxes.
            version: The version of the observations.
        """
        boxes: dict[str, Any] = dict(space.spaces)
        scales = [scales_of(name, box, version).reshape(-1) for name, box in boxes.items()]
        factors = (1.0 / np.concatenate(scales)).astype(np.float32)
        ends = np.cumsum([len(scale) for scale in scales]).tolist()
        self._parts = [  # the name, the columns and their factors
            (name, (..., slice(first, last)), factors[first:last])
            for name, first, last in zip(boxes, [0, *ends], ends, strict=False)
        ]
        low = np.concatenate([box.low.reshape(-1) for box in boxes.values()])
        high = np.concatenate([box.high.reshape(-1) for box in boxes.values()])
        low, high = (low * factors).astype(np.float32), (high * factors).astype(np.float32)
        self.space = Box(low, high, dtype=np.float32)

    def flatten(self, observation: Mapping[str, NDArray[Any]], axes: int = 0) -> NDArray[np.float32]:
        """Return observations as (…, n) numbers: of one learner, or of many along the first ``axes`` axes."""
        shape = next(iter(observation.values())).shape[:axes]
        flat = np.empty((*shape, *self.space.shape), np.float32)
        for name, columns, factors in self._parts:
            part = observation[name].reshape(*shape, -1)
            np.multiply(part, factors, out=flat[columns], dtype=np.float32, casting="unsafe")
        return flat


def scales_of(name: str, box: Box, version: int) -> NDArray[np.float64]:
    """Return the divisor of each number of a group or sensor, in the shape of its box."""
    for group in groups_of(version).values():
        if group.name == name:
            return np.array([SCALES.get(column.unit, COUNT) for column in group.columns])
    bound = np.maximum(np.abs(box.low.astype(np.float64)), np.abs(box.high.astype(np.float64)))
    return np.where(bound > LARGEST_BOUND, 100.0, np.maximum(bound, 1e-6))
