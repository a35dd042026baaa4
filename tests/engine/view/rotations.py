"""Rotations as replays have them: unit quaternions."""

import numpy as np
from numpy.typing import NDArray


def turned(quaternion: NDArray[np.float32], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn a vector by a unit quaternion x, y, z, w."""
    axis, w = quaternion[:3].astype(np.float64), float(quaternion[3])
    return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * vector)
