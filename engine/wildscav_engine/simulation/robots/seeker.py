"""The seeker looks for the target, goes there as soon as its team knows it, and picks up what it passes."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, levels_of, seek, wander
from wildscav_engine.specs.actions import Field

SEEKERS = levels_of("seeker", "looks for the target and goes there", 4)


@kernel
def find(now: Situation, action: NDArray[np.float32]) -> None:
    """Go to the target, else wander."""
    action[Field.PICK_UP] = 1.0
    if not seek(now, action):
        wander(now, action)
