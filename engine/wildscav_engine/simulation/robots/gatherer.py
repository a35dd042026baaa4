"""The gatherer: it collects the supply boxes in sight, and wanders if there are none."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import Situation, gather, keep_safe, levels_of, wander


@kernel
def collect(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep to the safe zone; otherwise gather supplies; otherwise wander."""
    if not keep_safe(now, action) and not gather(now, action):
        wander(now, action)


GATHERERS = levels_of("gatherer", "collects the supplies it sees", collect, 2)
