"""The walker wanders about and does nothing else."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, levels_of, wander

WALKERS = levels_of("walker", "wanders about", 1)


@kernel
def walk(now: Situation, action: NDArray[np.float32]) -> None:
    """Wander."""
    wander(now, action)
