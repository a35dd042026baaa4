"""Bodies of agents as meshes, with the same parts and colours as in the images of cameras."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.sensors.optics.dynamic_objects import INVINCIBLE_WHITE
from wildscav_engine.sensors.optics.object_parts import BODY, BODY_PARTS, colors_of_bodies
from wildscav_engine.view.recording import colors, coordinates

# The corners of a part are numbered by the bits (along, up, across).
SIDES = np.array([[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]])
GREY = 0.85  # weight of grey in the colours of a dead body
LYING = 0.2  # m by which a body on its back is raised


class BodyMesh(NamedTuple):
    """A body at the origin that faces north, in Rerun's coordinates; every side has its own vertices."""

    positions: NDArray[np.float32]  # (V, 3) m
    normals: NDArray[np.float32]  # (V, 3)
    triangles: NDArray[np.int32]  # (T, 3)


class BodyColors(NamedTuple):
    """The colours of a team's bodies."""

    usual: NDArray[np.uint8]  # (V, 3)
    invincible: NDArray[np.uint8]  # (V, 3)
    dead: NDArray[np.uint8]  # (V, 3)


@lru_cache(maxsize=1)
def body_mesh() -> BodyMesh:
    """Return the body of an agent."""
    corners = BODY_PARTS.corners[:, SIDES]  # (P, 6, 4, 3)
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 3] - corners[:, :, 0])
    outwards = corners.mean(axis=2) - corners.mean(axis=(1, 2))[:, None]
    normals *= np.sign((normals * outwards).sum(axis=-1, keepdims=True))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    first = 4 * np.arange(len(BODY) * len(SIDES), dtype=np.int32)[:, None]
    triangles = np.concatenate([first + np.array([[0, 1, 2]]), first + np.array([[0, 2, 3]])]).astype(
        np.int32
    )
    return BodyMesh(
        coordinates.points(corners.reshape(-1, 3)),
        coordinates.points(np.repeat(normals.reshape(-1, 3), 4, axis=0)),
        triangles,
    )


@lru_cache(maxsize=1024)
def body_colors(team: int) -> BodyColors:
    """Return the colours of a team's bodies, vertex by vertex."""
    parts = colors_of_bodies(team + 1)[team]
    usual = np.repeat(parts, 4 * len(SIDES), axis=0)
    invincible = usual + (255.0 - usual) * INVINCIBLE_WHITE
    dead = usual + (np.array(colors.DEAD) - usual) * GREY
    return BodyColors(*(np.round(each).astype(np.uint8) for each in (usual, invincible, dead)))


def poses(
    yaw: NDArray[np.float64], dead: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (N, 4) quaternions x, y, z, w and (N, 3) m offsets of bodies, standing or on their backs.

    Args:
        yaw: (N,) degrees, as in the game.
        dead: (N,) whether each body lies.
    """
    turn, tilt = np.radians(-yaw) / 2, np.where(dead, np.pi / 4, 0.0)
    about_z, upright = np.sin(turn), np.cos(turn)
    rotations = np.stack(
        [upright * np.sin(tilt), about_z * np.sin(tilt), about_z * np.cos(tilt), upright * np.cos(tilt)],
        axis=-1,
    )
    offsets = np.zeros((len(yaw), 3), np.float32)
    offsets[dead, 2] = LYING
    return rotations.astype(np.float32), offsets
