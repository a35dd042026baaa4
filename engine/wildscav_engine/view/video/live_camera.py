"""The camera above everybody of a match that is being played, which cannot know how they will move."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.view.video.cameras import Camera, camera_above, over_map, view_above, widened

OPENING, CLOSING = 0.5, 2.5  # s in which the view widens and narrows by about two thirds of the way


class LiveAbove:
    """Follows those who are alive, so that all are in view.

    Args:
        world: The world of the match.
        aspect: The width of pictures over their height.
    """

    def __init__(self, world: World, aspect: float) -> None:
        self._world, self._aspect = world, aspect
        self._box: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None  # (3,) m each, in view
        self._time = 0.0

    def at(self, positions: NDArray[np.float64], time: float) -> Camera:
        """Return the camera at a time; times never decrease.

        Args:
            positions: (N, 3) m, of those who are alive.
            time: s of the match.
        """
        if self._box is None or len(positions):
            places = positions if len(positions) else np.zeros((1, 3))
            self._box = self._glided(*widened(places.min(axis=0), places.max(axis=0)), time)
        self._time = time
        view = view_above(*self._box, self._aspect)
        return camera_above(over_map(self._world, view.eye[None], view.target[None])[0], view.target)

    def _glided(
        self, low: NDArray[np.float64], high: NDArray[np.float64], time: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the box that is in view, moved towards another one."""
        if self._box is None:
            return low, high
        passed = time - self._time
        wide, narrow = (1.0 - np.exp(-passed / seconds) for seconds in (OPENING, CLOSING))
        own_low, own_high = self._box
        return (
            own_low + np.where(low < own_low, wide, narrow) * (low - own_low),
            own_high + np.where(high > own_high, wide, narrow) * (high - own_high),
        )
