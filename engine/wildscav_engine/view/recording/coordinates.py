"""The conversion from the game's coordinates to those of Rerun.

The game is left-handed: x east, y up, z north. Rerun is right-handed, here with z up: x east, y north, z
up. The conversion swaps y and z, which is a reflection. Triangles must therefore reverse their winding order,
and a yaw, which is clockwise from above, becomes a negative rotation about z.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


def points(game: Array) -> NDArray[np.float32]:
    """Return points or vectors (..., 3) of the game in Rerun's coordinates."""
    return np.ascontiguousarray(game[..., [0, 2, 1]], np.float32)


def triangles(game: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return triangles (T, 3) with the winding order that keeps their outside in Rerun's coordinates."""
    return np.ascontiguousarray(game[:, [0, 2, 1]])


def directions(yaw: Array, pitch: Array) -> NDArray[np.float64]:
    """Return (..., 3) unit vectors of view directions in the game's coordinates, from (...) degrees."""
    turn, down = np.radians(yaw), np.radians(pitch)
    return np.stack([np.sin(turn) * np.cos(down), -np.sin(down), np.cos(turn) * np.cos(down)], axis=-1)


def camera_rotations(yaw: Array, pitch: Array) -> NDArray[np.float32]:
    """Return (N, 4) quaternions x, y, z, w that rotate Rerun's camera axes into its world.

    A camera there has x right, y down, z forwards. Yaw and pitch are the game's, (N,) degrees.
    """
    about_x, about_z = np.radians(-90.0 - np.asarray(pitch)) / 2, np.radians(-np.asarray(yaw)) / 2
    cos_x, sin_x, cos_z, sin_z = np.cos(about_x), np.sin(about_x), np.cos(about_z), np.sin(about_z)
    turned = np.stack([cos_z * sin_x, sin_z * sin_x, sin_z * cos_x, cos_z * cos_x], axis=-1)
    return np.ascontiguousarray(turned, np.float32)
