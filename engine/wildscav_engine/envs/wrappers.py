"""Wrappers for trainers that require observations and actions to be single Boxes."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Discrete, Space
from numpy.typing import NDArray

from wildscav_engine.envs.spaces.flattening import Flattener
from wildscav_engine.envs.spaces.observation import Readings


class FlatObservations(gymnasium.ObservationWrapper[NDArray[np.float32], Any, Readings]):
    """One row of numbers instead of a Dict: all groups and sensors concatenated, mostly in [-1, 1]."""

    def __init__(self, env: gymnasium.Env[Readings, Any]) -> None:
        """Wrap an environment whose observations are a Dict of Boxes; TypeError if they are not."""
        super().__init__(env)
        space: Any = env.observation_space
        if not isinstance(space, Dict) or not all(isinstance(box, Box) for box in space.values()):
            raise TypeError(f"the observation space is {space}, must be a Dict of Boxes")
        self._flattener = Flattener(space, getattr(getattr(env.unwrapped, "config", None), "version", 0))
        self.observation_space = self._flattener.space

    def observation(self, observation: Readings) -> NDArray[np.float32]:
        """Return an observation as (n,) numbers."""
        return self._flattener.flatten(observation)


class FlatActions(gymnasium.ActionWrapper[Readings, NDArray[np.float32], dict[str, Any]]):
    """Numbers in [-1, 1] instead of a Dict of fields, each scaled to the range of its field.

    For a choice between n values, the interval from -1 to 1 is divided into n equal parts.
    """

    def __init__(self, env: gymnasium.Env[Readings, dict[str, Any]]) -> None:
        """Wrap an environment with the action mode ``dict``; TypeError if it has another."""
        super().__init__(env)
        space: Any = env.action_space
        if not isinstance(space, Dict):
            raise TypeError(f"the action space is {space}, must be a Dict: choose action_mode='dict'")
        self._fields: dict[str, Space[Any]] = dict(space.spaces)
        self.action_space = Box(-1.0, 1.0, (len(self._fields),), np.float32)

    def action(self, action: NDArray[np.float32]) -> dict[str, Any]:
        """Return the fields for (k,) numbers in [-1, 1], in the order of the Dict."""
        shares = (np.clip(np.asarray(action, np.float64), -1.0, 1.0) + 1.0) / 2.0
        return {
            name: _scaled(space, float(share))
            for (name, space), share in zip(self._fields.items(), shares, strict=True)
        }


def _scaled(space: Space[Any], share: float) -> Any:
    """Return the value at a fraction from 0 to 1 of the range of a space."""
    if isinstance(space, Discrete):
        return min(int(space.n) - 1, int(share * int(space.n)))
    if isinstance(space, Box):
        return np.float32(space.low + (space.high - space.low) * share)
    raise TypeError(f"{space} has no order")
