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
        self._names = tuple(boxes)
        scales = np.concatenate([scales_of(name, box, version).reshape(-1) for name, box in boxes.items()])
        self._factors = (1.0 / scales).astype(np.float32)
        low = np.concatenate([box.low.reshape(-1) for box in boxes.values()])
        high = np.concatenate([box.high.reshape(-1) for box in boxes.values()])
        low, high = (low * self._factors).astype(np.float32), (high * self._factors).astype(np.float32)
        self.space = Box(low, high, dtype=np.float32)

    def flatten(self, observation: Mapping[str, NDArray[Any]], axes: int = 0) -> NDArray[np.float32]:
        """Return observations as (…, n) numbers: of one learner, or of many along the first ``axes`` axes."""
        parts = [observation[name] for name in self._names]
        flat = np.concatenate(
            [part.reshape(*part.shape[:axes], -1) for part in parts], axis=-1, dtype=np.float32
        )
        flat *= self._factors
        return flat


def scales_of(name: str, box: Box, version: int) -> NDArray[np.float64]:
    """Return the divisor of each number of a group or sensor, in the shape of its box."""
    for group in groups_of(version).values():
        if group.name == name:
            return np.array([SCALES.get(column.unit, COUNT) for column in group.columns])
    bound = np.maximum(np.abs(box.low.astype(np.float64)), np.abs(box.high.astype(np.float64)))
    return np.where(bound > LARGEST_BOUND, 100.0, np.maximum(bound, 1e-6))
