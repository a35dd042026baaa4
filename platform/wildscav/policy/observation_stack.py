"""Stacks of the last observations, as the frame-stacking wrappers of training libraries make them."""

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.policy.observation_groups import Readings

Stacked = Readings | NDArray[Any]


class Stack:
    """Stacks the last observations into one.

    Args:
        axis: "last": along the last axis, as ``VecFrameStack`` of Stable-Baselines3 does; "new": along a new
            first axis, as ``FrameStackObservation`` of Gymnasium does.
        padding: What fills the stack before the first observation: "zero", the default of the former wrapper,
            or "first", the first observation repeated, the default of the latter.

    Raises:
        ValueError: An argument has another value.
    """

    def __init__(self, count: int, axis: str, padding: str) -> None:
        if count < 1 or axis not in ("last", "new") or padding not in ("zero", "first"):
            raise ValueError(f"a stack of {count} along axis {axis!r} with padding {padding!r}")
        self._axis, self._padding = axis, padding
        self._kept: deque[Stacked] = deque(maxlen=count)

    def clear(self) -> None:
        """Begin a new episode."""
        self._kept.clear()

    def push(self, observation: Stacked) -> Stacked:
        """Return the last observations, the newest last."""
        if not self._kept:
            before = observation if self._padding == "first" else _each(np.zeros_like, observation)
            self._kept.extend([before] * (self._kept.maxlen or 1))
        self._kept.append(observation)
        if self._axis == "new":
            return _together(np.stack, self._kept)
        return _together(lambda arrays: np.concatenate(arrays, axis=-1), self._kept)


def _each(change: Callable[[NDArray[Any]], NDArray[Any]], observation: Stacked) -> Stacked:
    if isinstance(observation, Mapping):
        return {name: change(values) for name, values in observation.items()}
    return change(observation)


def _together(join: Callable[[list[NDArray[Any]]], NDArray[Any]], kept: "deque[Any]") -> Stacked:
    if isinstance(kept[0], Mapping):
        return {name: join([one[name] for one in kept]) for name in kept[0]}
    return join(list(kept))
