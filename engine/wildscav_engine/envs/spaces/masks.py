"""Action masks of flat environments: one row for all choices instead of Gymnasium's tuple of rows."""

from typing import Any

import numpy as np
from gymnasium.spaces import MultiDiscrete, Space
from numpy.typing import NDArray


class FlatMaskDiscrete(MultiDiscrete):
    """A MultiDiscrete whose ``sample`` also accepts a mask in one row, as flat environments provide it."""

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return a random choice among those that a mask allows.

        Args:
            mask: (all choices,) int8, 1 where a choice is allowed; or a tuple with a row per field.
            probability: As in Gymnasium.
        """
        if isinstance(mask, np.ndarray) and mask.ndim == 1 and len(mask) == self.nvec.sum():
            mask = tuple(np.split(mask, np.cumsum(self.nvec)[:-1]))
        return super().sample(mask, probability)


def flat_space(space: Space[Any]) -> Space[Any]:
    """Return an action space that accepts the masks of a flat environment."""
    return FlatMaskDiscrete(space.nvec) if isinstance(space, MultiDiscrete) else space


def flat_mask(mask: Any) -> NDArray[np.int8] | None:
    """Return the action mask of an action mode as one row; None for a Dict, which has none."""
    if isinstance(mask, tuple):
        return np.concatenate(mask)
    return mask if isinstance(mask, np.ndarray) else None
