"""The walker: it only wanders."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, keep_safe, levels_of, wander


@kernel
def walk(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else wander."""
    if not keep_safe(now, action):
        wander(now, action)


WALKERS = levels_of("walker", "wanders about", walk, 1)
