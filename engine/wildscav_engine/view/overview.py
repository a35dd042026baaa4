"""The initial camera of the free view of a replay, which shows the whole map or all agents."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.view.recording.history import History

WHOLE_MAP = 600.0  # m, largest map that is in view as a whole; on larger maps, all agents are in view
MIN_EXTENT, MARGIN = 60.0, 6.0  # m, least extent in view; margin around the agents
OBJECT_HEIGHT = 10.0  # m, of houses and trees above the highest ground
FROM = np.array([-0.30, 0.62, -0.72])  # the direction of the camera: the south-west, from above
VIEW_ANGLE = 55.0  # degrees vertically, as in the viewer's free camera
ASPECT = 1.2  # width over height of a view; most views are wider and show more
FILLED = 0.95  # of half the width and half the height, the reach of the outermost corners


class Overview(NamedTuple):
    """A camera in the game's coordinates."""

    eye: NDArray[np.float64]  # (3,) m
    target: NDArray[np.float64]  # (3,) m, the point in the center of the view


def overview(history: History, world: World) -> Overview:
    """Return the nearest camera in a fixed direction that sees the whole map, or all agents."""
    tall = float(np.tan(np.radians(VIEW_ANGLE) / 2))
    return fitted(_corners(history, world), tall * ASPECT, tall)


def _corners(history: History, world: World) -> NDArray[np.float64]:
    """Return (8, 3) m the corners of the box that must be in view."""
    positions = history.agents.position.reshape(-1, 3)
    if history.target is not None:
        positions = np.concatenate([positions, history.target[None]])
    low, high = positions.min(axis=0) - MARGIN, positions.max(axis=0) + MARGIN
    half = -world.corner
    if 2 * float(max(half)) <= WHOLE_MAP:
        low = np.array([-half[0], world.heights.min(), -half[1]])
        high = np.array([half[0], world.heights.max() + OBJECT_HEIGHT, half[1]])
    short = np.maximum(0.0, MIN_EXTENT - (high - low)) / 2 * [1, 0, 1]
    return box_corners(low - short, high + short)


def box_corners(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (8, 3) m the corners of a box."""
    return np.array(list(product(*zip(low, high, strict=True))))


def fitted(
    corners: NDArray[np.float64], wide: float, tall: float, way: NDArray[np.float64] = FROM
) -> Overview:
    """Return the camera whose view (N, 3) m corners fill: center them, then move as close as possible.

    The tangents of half its angles of view are ``wide`` and ``tall``; ``way`` leads to it from what is seen.
    """
    back = way / np.linalg.norm(way)
    right = np.cross([0.0, 1.0, 0.0], -back)
    right /= np.linalg.norm(right)
    up = np.cross(-back, right)
    slopes = np.array([wide, tall]) * FILLED
    offsets = corners - corners.mean(axis=0)
    across, depth = np.stack([offsets @ right, offsets @ up], axis=-1), offsets @ -back
    shift = np.zeros(2)
    for _ in range(8):  # each iteration more than halves the error
        distance = float(np.max(np.abs(across - shift) / slopes - depth[:, None]))
        seen = (across - shift) / (depth + distance)[:, None] / slopes
        shift = shift + (seen.max(axis=0) + seen.min(axis=0)) / 2 * slopes * distance
    distance = float(np.max(np.abs(across - shift) / slopes - depth[:, None]))
    target = corners.mean(axis=0) + shift[0] * right + shift[1] * up
    return Overview(target + distance * back, target)
