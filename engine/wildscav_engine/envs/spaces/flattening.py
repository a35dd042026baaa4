"""Flat observations: one row of numbers, each divided by a typical scale."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

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


class Run(NamedTuple):
    """Columns of flat observations that come from one place."""

    sensor: str  # the readings of a sensor, or "" for columns of rows
    source: tuple[Any, ...]  # the index of these columns in rows
    target: tuple[Any, ...]  # their index in flat observations
    factors: NDArray[np.float32]


class Flattener:
    """Converts observations to rows of numbers."""

    def __init__(self, space: Dict, version: int = 0) -> None:
        """Create a flattener of observations in the space of one learner, a Dict of Boxes."""
        boxes: dict[str, Any] = dict(space.spaces)
        scales = [scales_of(name, box, version).reshape(-1) for name, box in boxes.items()]
        self._factors = factors = (1.0 / np.concatenate(scales)).astype(np.float32)
        ends = np.cumsum([len(scale) for scale in scales]).tolist()
        starts = [0, *ends[:-1]]
        self._columns = dict(zip(boxes, map(slice, starts, ends), strict=True))
        low = np.concatenate([box.low.reshape(-1) for box in boxes.values()])
        high = np.concatenate([box.high.reshape(-1) for box in boxes.values()])
        low, high = (low * factors).astype(np.float32), (high * factors).astype(np.float32)
        self.space = Box(low, high, dtype=np.float32)

    def runs(self, groups: Sequence[tuple[str, int, int]]) -> list[Run]:
        """Return where the columns of flat observations come from, as few as possible.

        The groups are those of ``Layout``: they are side by side in rows, in the order of their names.
        """
        in_rows = {name: (first, last) for name, first, last in groups}
        found: list[Run] = []
        for name, columns in self._columns.items():
            if name not in in_rows:
                found.append(Run(name, (), (..., columns), self._factors[columns]))
                continue
            first, last = in_rows[name]
            begin = columns.start
            if found and not found[-1].sensor:
                before = found.pop()
                first, begin = before.source[1].start, before.target[1].start
            run = slice(begin, columns.stop)
            found.append(Run("", (..., slice(first, last)), (..., run), self._factors[run]))
        return found

    def flatten(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """Return the observation of one learner as (n,) numbers."""
        parts = [observation[name].reshape(-1) for name in self._columns]
        return np.concatenate(parts, dtype=np.float32) * self._factors


def write_flat(
    runs: Sequence[Run],
    rows: NDArray[np.float32],
    readings: Mapping[str, NDArray[Any]],
    flat: NDArray[np.float32],
) -> None:
    """Write (B, S, n) flat observations from (B, S, …) rows and readings of sensors."""
    for sensor, source, target, factors in runs:
        part = readings[sensor].reshape(*rows.shape[:2], -1) if sensor else rows[source]
        np.multiply(part, factors, out=flat[target], dtype=np.float32, casting="unsafe")


def scales_of(name: str, box: Box, version: int) -> NDArray[np.float64]:
    """Return the divisor of each number of a group or sensor, in the shape of its box."""
    for group in groups_of(version).values():
        if group.name == name:
            return np.array([SCALES.get(column.unit, COUNT) for column in group.columns])
    bound = np.maximum(np.abs(box.low.astype(np.float64)), np.abs(box.high.astype(np.float64)))
    return np.where(bound > LARGEST_BOUND, 100.0, np.maximum(bound, 1e-6))
