"""Wrappers for trainers that want one Box of each: of what is observed and of what is done."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, Space
from numpy.typing import NDArray

from wildscav_engine.envs.columns import GROUPS
from wildscav_engine.envs.observation import Observation

# What is usual for a number, by its unit: it is divided by this. What sensors read is divided by the bound of
# its space, or by 100 where that is larger than any picture needs.
SCALES = {"m": 100.0, "m/s": 10.0, "degrees": 180.0, "s": 100.0, "hp": 100.0, "0 or 1": 1.0}
COUNT, LARGEST_BOUND = 10.0, 2000.0


class FlatObservations(gymnasium.ObservationWrapper[NDArray[np.float32], Any, Observation]):
    """One row of numbers instead of a Dict: all groups and sensors end to end, mostly in [-1, 1]."""

    def __init__(self, env: gymnasium.Env[Observation, Any]) -> None:
        """Wrap an environment whose observations are a Dict of Boxes.

        Raises:
            TypeError: They are not.
        """
        super().__init__(env)
        space: Any = env.observation_space
        if not isinstance(space, Dict) or not all(isinstance(box, Box) for box in space.values()):
            raise TypeError(f"the observations are of {space}, must be of a Dict of Boxes")
        self._flattener = Flattener(space)
        self.observation_space = self._flattener.space

    def observation(self, observation: Observation) -> NDArray[np.float32]:
        """Return (n,) the numbers of an observation."""
        return self._flattener.flatten(observation)


class Flattener:
    """Turns observations into rows of numbers."""

    def __init__(self, space: Dict) -> None:
        """Take the space of one learner's observations: a Dict of Boxes."""
        boxes: dict[str, Any] = dict(space.spaces)
        self._names = tuple(boxes)
        scales = np.concatenate([_scales_of(name, box).reshape(-1) for name, box in boxes.items()])
        self._factors = (1.0 / scales).astype(np.float32)
        low = np.concatenate([box.low.reshape(-1) for box in boxes.values()])
        high = np.concatenate([box.high.reshape(-1) for box in boxes.values()])
        low, high = (low * self._factors).astype(np.float32), (high * self._factors).astype(np.float32)
        self.space = Box(low, high, dtype=np.float32)

    def flatten(self, observation: Observation) -> NDArray[np.float32]:
        """Return (n,) the numbers of one learner's observation."""
        flat = np.concatenate([observation[name].reshape(-1) for name in self._names], dtype=np.float32)
        flat *= self._factors
        return flat

    def flatten_all(self, observation: Observation, axes: int = 1) -> NDArray[np.float32]:
        """Return (…, n) the numbers of many learners' observations, which lie along the first axes."""
        parts = [observation[name] for name in self._names]
        flat = np.concatenate(
            [part.reshape(*part.shape[:axes], -1) for part in parts], axis=-1, dtype=np.float32
        )
        flat *= self._factors
        return flat


def _scales_of(name: str, box: Box) -> NDArray[np.float64]:
    """Return what is usual for each number of a group or sensor."""
    for group in GROUPS.values():
        if group.name == name:
            return np.array([SCALES.get(column.unit, COUNT) for column in group.columns])
    bound = np.maximum(np.abs(box.low.astype(np.float64)), np.abs(box.high.astype(np.float64)))
    return np.where(bound > LARGEST_BOUND, 100.0, np.maximum(bound, 1e-6))


class FlatActions(gymnasium.ActionWrapper[Observation, NDArray[np.float32], dict[str, Any]]):
    """Numbers in [-1, 1] instead of a Dict of fields, each stretched to the range of its field.

    A choice between n things is the n-th part of the way from -1 to 1 in which the number lies.
    """

    def __init__(self, env: gymnasium.Env[Observation, dict[str, Any]]) -> None:
        """Wrap an environment in the action mode ``dict``.

        Raises:
            TypeError: It is in another.
        """
        super().__init__(env)
        space: Any = env.action_space
        if not isinstance(space, Dict):
            raise TypeError(f"the actions are of {space}, must be of a Dict: choose action_mode='dict'")
        self._fields: dict[str, Space[Any]] = dict(space.spaces)
        self.action_space = Box(-1.0, 1.0, (len(self._fields),), np.float32)

    def action(self, action: NDArray[np.float32]) -> dict[str, Any]:
        """Return the fields of (k,) numbers in [-1, 1], in the order of the Dict."""
        shares = (np.clip(np.asarray(action, np.float64), -1.0, 1.0) + 1.0) / 2.0
        return {
            name: _stretched(space, float(share))
            for (name, space), share in zip(self._fields.items(), shares, strict=True)
        }


def _stretched(space: Space[Any], share: float) -> Any:
    """Return what lies at a share from 0 to 1 of a space."""
    if isinstance(space, Discrete):
        return min(int(space.n) - 1, int(share * int(space.n)))
    if isinstance(space, Box):
        return np.float32(space.low + (space.high - space.low) * share)
    raise TypeError(f"{space} has no order")
