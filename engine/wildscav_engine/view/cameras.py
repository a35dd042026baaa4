"""Where the two cameras that follow an agent stand: at its eyes, and behind it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.body import EYE_HEIGHT
from wildscav_engine.geometry.rays import NOTHING_HIT, cast_ray
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.state import Agents
from wildscav_engine.view.frame import directions

BEHIND = 5.0  # m, from the head to the camera
PITCH_BEHIND = 13.0  # degrees downwards, when the agent looks level
HEAD = 1.9  # m above the soles, what the camera behind looks at
CLEARANCE = 0.3  # m that the camera stays before a wall
SMOOTH_STEPS = 3  # the camera behind turns with the mean of so many steps before and after


class Poses(NamedTuple):
    """A camera's places and directions over time."""

    position: NDArray[np.float64]  # (T, 3) m
    yaw: NDArray[np.float64]  # (T,) degrees
    pitch: NDArray[np.float64]  # (T,) degrees, positive looks down


def at_the_eyes(agents: Agents, seat: int) -> Poses:
    """Return what the depth sensor's camera does too."""
    position = agents.position[:, seat] + np.array([0.0, EYE_HEIGHT, 0.0])
    return Poses(position, agents.yaw[:, seat], agents.pitch[:, seat])


def behind(world: World, agents: Agents, seat: int) -> Poses:
    """Return a camera behind and above the agent, nearer where a wall or a slope is in the way."""
    forwards = _smoothed(directions(agents.yaw[:, seat], np.zeros(len(agents.yaw))))
    yaw = np.degrees(np.arctan2(forwards[:, 0], forwards[:, 2]))
    pitch = PITCH_BEHIND + 0.5 * _smoothed(agents.pitch[:, seat, None])[:, 0]
    head = agents.position[:, seat] + np.array([0.0, HEAD, 0.0])
    position = np.empty_like(head)
    _pull_back(world, head, -directions(yaw, pitch), BEHIND, position)
    return Poses(position, yaw, pitch)


def _smoothed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the running mean of (T, N) values over time."""
    padded = np.pad(values, ((SMOOTH_STEPS, SMOOTH_STEPS), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * SMOOTH_STEPS + 1, axis=0)
    return np.asarray(windows.mean(axis=-1), np.float64)


@kernel
def _pull_back(
    world: World,
    start: NDArray[np.float64],
    way: NDArray[np.float64],
    length: float,
    ends: NDArray[np.float64],
) -> None:
    """Go from (T, 3) points along (T, 3) unit vectors, up to a length, and stop short of what is hit."""
    for row in range(start.shape[0]):
        x, y, z = start[row, 0], start[row, 1], start[row, 2]
        hit = cast_ray(world, x, y, z, way[row, 0], way[row, 1], way[row, 2], length + CLEARANCE)
        far = length if hit.solid == NOTHING_HIT else max(0.0, min(length, hit.distance - CLEARANCE))
        for axis in range(3):
            ends[row, axis] = start[row, axis] + way[row, axis] * far
