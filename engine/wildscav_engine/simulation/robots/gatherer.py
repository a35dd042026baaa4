"""The gatherer collects the supply boxes that it sees and wanders where it sees none."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, gather, levels_of, wander

GATHERERS = levels_of("gatherer", "collects the supplies it sees", 2)


@kernel
def collect(now: Situation, action: NDArray[np.float32]) -> None:
    """Gather, else wander."""
    if not gather(now, action):
        wander(now, action)
