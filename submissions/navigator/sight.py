"""What the depth map shows ahead: how far each direction is free, by the slope of what stands there."""

import math

import numpy as np
from numpy.typing import NDArray

from wildscav.geometry import BODY_HEIGHT, EYE_HEIGHT

FIELD_OF_VIEW = 90.0  # degrees, as in submission.toml
FAR = 8.0  # m ahead that are examined
BIN = 0.5  # m, in which the highest point counts
HALF_WIDTH = 0.6  # m on either side of the way that must be free
STEEPEST = 1.0  # slope that can be climbed
LEAST = 0.5  # m; what rises less can be stepped on
HEADINGS = tuple(float(angle) for angle in range(-40, 41, 8))  # degrees to the right of the view


class Sight:
    """Measures how far each heading is free."""

    def free_ways(self, depth: NDArray[np.float32], pitch: float) -> dict[float, float]:
        """Return m that are free ahead, by heading in degrees to the right of the view.

        Args:
            depth: (height, width) m, along the view axis.
            pitch: Degrees, positive looks down.
        """
        ahead, aside, height = _points(depth, pitch)
        seen = (ahead > 0.0) & (ahead < FAR) & (height < BODY_HEIGHT)
        ahead, aside, height = ahead[seen], aside[seen], height[seen]
        return {heading: _free(ahead, aside, height, math.radians(heading)) for heading in HEADINGS}


def _points(depth: NDArray[np.float32], pitch: float) -> tuple[NDArray[np.float64], ...]:
    """Return for each pixel m ahead and to the right of the agent, and above its soles."""
    rows, columns = depth.shape
    size = 2.0 * math.tan(math.radians(FIELD_OF_VIEW / 2.0)) / columns
    away = depth.astype(np.float64)
    aside = away * ((np.arange(columns) + 0.5 - columns / 2.0) * size)
    above = away * ((rows / 2.0 - 0.5 - np.arange(rows)) * size)[:, None]
    down = math.radians(pitch)
    ahead = away * math.cos(down) + above * math.sin(down)
    return ahead, aside, EYE_HEIGHT + above * math.cos(down) - away * math.sin(down)


def _free(
    ahead: NDArray[np.float64], aside: NDArray[np.float64], height: NDArray[np.float64], heading: float
) -> float:
    """Return how far a heading is free, m: up to what rises too high and too steeply to be walked."""
    along = ahead * math.cos(heading) + aside * math.sin(heading)
    across = aside * math.cos(heading) - ahead * math.sin(heading)
    on_way = (np.abs(across) < HALF_WIDTH) & (along > 0.0) & (along < FAR)
    tops = np.full(int(FAR / BIN), -np.inf)
    np.maximum.at(tops, (along[on_way] / BIN).astype(np.int64), height[on_way])
    last, last_at = 0.0, 0.0
    for number, top in enumerate(tops.tolist()):
        middle = (number + 0.5) * BIN
        if top == -math.inf:
            continue
        rise = top - last
        if rise > LEAST and rise > STEEPEST * (middle - last_at):
            return number * BIN
        last, last_at = top, middle
    return FAR
