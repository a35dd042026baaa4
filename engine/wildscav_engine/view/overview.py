"""Where the free view of a replay looks from: so that all of what matters is in the picture."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.view.recording.history import History

WHOLE_MAP = 600.0  # m, up to which all of a map is in view; on larger ones all that moves is
NEAREST_FRAME, MARGIN = 60.0, 6.0  # m, least extent that is in view; around what moves
TALL = 10.0  # m, of houses and trees over the highest ground
FROM = np.array([-0.30, 0.62, -0.72])  # the south-west, from above
VIEW_ANGLE = 55.0  # degrees from top to bottom, what the viewer's free camera has
ASPECT = 1.2  # width over height of a view: most are wider, which then shows more
FILLED = 0.95  # of the half width and half height, how far out the corners come


class Overview(NamedTuple):
    """A camera in the game's frame."""

    eye: NDArray[np.float64]  # (3,) m
    target: NDArray[np.float64]  # (3,) m, what is in the middle


def overview(history: History, world: World) -> Overview:
    """Return the nearest camera of one direction that has the whole map, or all that moves, in view."""
    return _fitted(_corners(history, world))


def _corners(history: History, world: World) -> NDArray[np.float64]:
    """Return the (8, 3) m corners of the box that has to be in view."""
    places = history.agents.position.reshape(-1, 3)
    if history.target is not None:
        places = np.concatenate([places, history.target[None]])
    low, high = places.min(axis=0) - MARGIN, places.max(axis=0) + MARGIN
    half = -world.corner
    if 2 * float(max(half)) <= WHOLE_MAP:
        low = np.array([-half[0], world.heights.min(), -half[1]])
        high = np.array([half[0], world.heights.max() + TALL, half[1]])
    short = np.maximum(0.0, NEAREST_FRAME - (high - low)) / 2 * [1, 0, 1]
    low, high = low - short, high + short
    return np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )


def _fitted(corners: NDArray[np.float64]) -> Overview:
    """Move a camera until the corners fill its picture: centre them, then come as near as they allow."""
    back = FROM / np.linalg.norm(FROM)
    right = np.cross([0.0, 1.0, 0.0], -back)
    right /= np.linalg.norm(right)
    up = np.cross(-back, right)
    tall = np.tan(np.radians(VIEW_ANGLE) / 2) * FILLED
    slopes = np.array([tall * ASPECT, tall])
    offsets = corners - corners.mean(axis=0)
    across, depth = np.stack([offsets @ right, offsets @ up], axis=-1), offsets @ -back
    shift = np.zeros(2)
    for _ in range(8):  # each round halves what is left to do, and more
        distance = float(np.max(np.abs(across - shift) / slopes - depth[:, None]))
        seen = (across - shift) / (depth + distance)[:, None] / slopes
        shift = shift + (seen.max(axis=0) + seen.min(axis=0)) / 2 * slopes * distance
    distance = float(np.max(np.abs(across - shift) / slopes - depth[:, None]))
    target = corners.mean(axis=0) + shift[0] * right + shift[1] * up
    return Overview(target + distance * back, target)
