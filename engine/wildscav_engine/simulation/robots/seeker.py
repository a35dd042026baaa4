"""The seeker: it searches for the target, walks there once it is known, and picks up boxes on the way."""

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
