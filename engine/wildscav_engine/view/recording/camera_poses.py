"""The poses of the two cameras that follow an agent: at its eyes, and above and behind it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import Agents
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.view.recording.coordinates import directions

BACK, ABOVE = 7.0, 6.0  # m from the agent's head to the camera
HEAD = 1.7  # m above the soles, the point at which the camera looks
CLEARANCE = 1.0  # m that the camera keeps above the ground; walls and trees in between are transparent
SMOOTH_STEPS = 5  # before and after, over whose mean the camera turns


@kernel
def lay_on_ground(world: World, lift: float, points: NDArray[np.float64]) -> None:
    """Set the height of (N, 3) points to ``lift`` metres above the ground."""
    for point in range(points.shape[0]):
        points[point, 1] = ground_at(world, points[point, 0], points[point, 2]).height + lift


class Poses(NamedTuple):
    """The positions and directions of a camera over time."""

    position: NDArray[np.float64]  # (T, 3) m
    yaw: NDArray[np.float64]  # (T,) degrees
    pitch: NDArray[np.float64]  # (T,) degrees, positive looks down


def at_the_eyes(agents: Agents, seat: int) -> Poses:
    """Return the poses of an agent's eyes, which are those of its depth camera."""
    position = agents.position[:, seat] + np.array([0.0, EYE_HEIGHT, 0.0])
    return Poses(position, agents.yaw[:, seat], agents.pitch[:, seat])


def above(world: World, agents: Agents, seat: int) -> Poses:
    """Return the poses of a camera that looks at an agent from above and behind, never below the ground."""
    forwards = running_mean(directions(agents.yaw[:, seat], np.zeros(len(agents.yaw))), SMOOTH_STEPS)
    yaw = np.degrees(np.arctan2(forwards[:, 0], forwards[:, 2]))
    head = agents.position[:, seat] + np.array([0.0, HEAD, 0.0])
    position = head - BACK * directions(yaw, np.zeros(len(yaw)))
    ground = position.copy()
    lay_on_ground(world, CLEARANCE, ground)
    position[:, 1] = np.maximum(head[:, 1] + ABOVE, ground[:, 1])
    pitch = np.degrees(np.arctan2(position[:, 1] - head[:, 1], BACK))
    return Poses(position, yaw, pitch)


def windows_around(values: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """Return (…, 2 * steps + 1) the values of some steps before and after each; time is their first axis."""
    padded = np.pad(values, [(steps, steps)] + [(0, 0)] * (values.ndim - 1), mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * steps + 1, axis=0)


def running_mean(values: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """Return the mean of values over some steps before and after each."""
    return np.asarray(windows_around(values, steps).mean(axis=-1), np.float64)
