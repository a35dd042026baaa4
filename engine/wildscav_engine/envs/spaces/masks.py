"""Action masks of flat environments: one row for all choices, where Gymnasium has a tuple of rows."""

from typing import Any

import numpy as np
from gymnasium.spaces import MultiDiscrete, Space
from numpy.typing import NDArray


class RowMasked(MultiDiscrete):
    """A MultiDiscrete whose ``sample`` takes a mask in one row, too, as flat environments tell it."""

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return a random choice of what a mask allows.

        Args:
            mask: (all choices,) int8, 1 where a choice is allowed; or a tuple with a row for each place.
            probability: As Gymnasium takes it.
        """
        if isinstance(mask, np.ndarray) and mask.ndim == 1 and len(mask) == self.nvec.sum():
            mask = tuple(np.split(mask, np.cumsum(self.nvec)[:-1]))
        return super().sample(mask, probability)


def flat_space(space: Space[Any]) -> Space[Any]:
    """Return an action space that takes the masks of a flat environment."""
    return RowMasked(space.nvec) if isinstance(space, MultiDiscrete) else space


def flat_mask(mask: Any) -> NDArray[np.int8] | None:
    """Return the action mask of an action mode in one row; None for that of a Dict, which has none."""
    if isinstance(mask, tuple):
        return np.concatenate(mask)
    return mask if isinstance(mask, np.ndarray) else None
