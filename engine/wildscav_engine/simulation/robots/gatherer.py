"""The gatherer collects the supply boxes that it sees and wanders where it sees none."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, gather, keep_safe, levels_of, wander


@kernel
def collect(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep safe, else gather, else wander."""
    if not keep_safe(now, action) and not gather(now, action):
        wander(now, action)


GATHERERS = levels_of("gatherer", "collects the supplies it sees", collect, 2)
