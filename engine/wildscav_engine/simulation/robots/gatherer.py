"""The gatherer: it collects the boxes in sight, and if there are none, visits the hot spot or wanders."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.robots.base import (
    Situation,
    gather,
    keep_safe,
    levels_of,
    visit_hot_spot,
    wander,
)


@kernel
def collect(now: Situation, action: NDArray[np.float32]) -> None:
    """Keep to the safe zone; otherwise gather supplies; otherwise visit the hot spot or wander."""
    if keep_safe(now, action) or gather(now, action) or visit_hot_spot(now, action):
        return
    wander(now, action)


GATHERERS = levels_of("gatherer", "collects the supplies it sees", collect, 2)
