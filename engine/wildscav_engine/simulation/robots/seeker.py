"""The seeker looks for the target, goes there as soon as its team knows it, and picks up what it passes."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, keep_safe, levels_of, seek, wander
from wildscav_engine.specs.actions import Field


@kernel
def find(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else go to the target, else wander."""
    if keep_safe(now, action):
        return
    action[Field.PICK_UP] = 1.0
    if not seek(now, action):
        wander(now, action)


SEEKERS = levels_of("seeker", "looks for the target and goes there", find, 4)
