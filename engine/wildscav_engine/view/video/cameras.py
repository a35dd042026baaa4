"""The cameras of a video: at an agent's eyes, behind it, or above everybody."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.world import World
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.overview import Overview, box_corners, fitted
from wildscav_engine.view.recording.camera_poses import running_mean, windows_around
from wildscav_engine.view.recording.coordinates import directions
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.moments import InterpolatedState

Vector = NDArray[np.float64]

ANGLE = 75.0  # degrees, of view, horizontally, as of the agents' own camera
FAR = 300.0  # m, where the haze hides everything
ABOVE_FAR = 1200.0  # m, for the camera above everybody
BEHIND = 4.6  # m, between a head and the camera behind it
HEAD = 1.75  # m above the soles
TILT = 14.0  # degrees, by which it looks down
SHOULDER = 0.55  # m to the right, so that the agent does not hide what it aims at
CLEARANCE = 0.35  # m, kept from walls and the ground
CLOSEST = 1.1  # m; from nearer by, the agent's own body is not shown
TURN = 0.5  # s before and after, over whose mean the camera behind an agent turns
WALL = 0.3  # s before and after, for which it keeps off walls
GLIDE = 2.5  # s before and after, over whose mean the camera above everybody moves
MARGIN, LEAST_EXTENT = 12.0, 70.0  # m around the agents, and m in view at least
FROM = np.array([0.0, 0.8, -0.6])  # the direction of the camera above everybody: the south
EDGE = 3.0  # m that it keeps from the edge of the map
ROOF = 8.0  # m above the agents, in view


class Camera(NamedTuple):
    """Where a picture is taken from."""

    eye: Vector  # (3,) m
    yaw: float  # degrees
    pitch: float  # degrees, positive looks down
    hidden: int | None  # the seat whose body is not shown
    far: float = FAR  # m

    def onto(self, points: NDArray[np.float64], width: int, height: int) -> NDArray[np.float64]:
        """Return (N, 3) of (N, 3) m points: pixels to the right, pixels down, and m ahead of the camera."""
        turn, down = np.array(self.yaw), np.array(self.pitch)
        ahead, level = directions(turn, down), directions(turn, 0 * down)
        right = np.array([level[2], 0.0, -level[0]])
        ways = points - self.eye
        depth = ways @ ahead
        scale = width / 2 / np.tan(np.radians(ANGLE / 2)) / np.maximum(depth, 1e-3)
        return np.stack(
            [width / 2 + scale * (ways @ right), height / 2 - scale * (ways @ np.cross(ahead, right)), depth],
            axis=-1,
        )


def at_the_eyes(moment: InterpolatedState, seat: int) -> Camera:
    """Return the camera at an agent's eyes."""
    eye = moment.position[seat] + np.array([0.0, EYE_HEIGHT, 0.0])
    return Camera(eye, float(moment.yaw[seat]), float(moment.pitch[seat]), seat)


def behind(world: World, moment: InterpolatedState, seat: int) -> Camera:
    """Return the camera behind an agent as it stands, without knowing how it will move."""
    yaw, pitch = float(moment.yaw[seat]), TILT + 0.4 * float(moment.pitch[seat])
    distance = _room(world, moment.position[seat], yaw, pitch)
    return _camera_behind(moment.position[seat], yaw, pitch, distance, seat)


def _room(world: World, position: Vector, yaw: float, pitch: float) -> float:
    """Return how many m behind the head of an agent there is room for a camera."""
    x, y, z = (position + _shoulder(yaw)).tolist()
    dx, dy, dz = (-directions(np.array(yaw), np.array(pitch))).tolist()
    hit = raycast(world, x, y, z, dx, dy, dz, BEHIND + CLEARANCE)
    return max(0.2, min(BEHIND, float(hit.distance) - CLEARANCE))


def _camera_behind(position: Vector, yaw: float, pitch: float, distance: float, seat: int) -> Camera:
    eye = position + _shoulder(yaw) - distance * directions(np.array(yaw), np.array(pitch))
    return Camera(eye, yaw, pitch, seat if distance < CLOSEST else None)


class Follower:
    """The camera behind one agent, which turns smoothly and stays on this side of walls."""

    def __init__(self, world: World, history: History, seat: int) -> None:
        """Work out how the camera turns, and how far it is from the agent."""
        agents, self._frames, self._seat = history.agents, history.frame, seat
        forwards = directions(agents.yaw[:, seat], np.zeros(len(agents.yaw)))
        steps = _steps(history, TURN)
        smooth = running_mean(forwards, steps)
        self._yaw = np.unwrap(np.degrees(np.arctan2(smooth[:, 0], smooth[:, 2])), period=360.0)
        self._pitch = TILT + 0.4 * running_mean(agents.pitch[:, seat], steps)
        poses = zip(agents.position[:, seat], self._yaw.tolist(), self._pitch.tolist(), strict=True)
        room = np.array([_room(world, *pose) for pose in poses])
        self._distance = -_greatest(-room, _steps(history, WALL))

    def at(self, moment: InterpolatedState) -> Camera:
        """Return the camera at a moment."""
        yaw, pitch, distance = (
            float(np.interp(moment.frame, self._frames, values))
            for values in (self._yaw, self._pitch, self._distance)
        )
        return _camera_behind(moment.position[self._seat], yaw, pitch, distance, self._seat)


class Above:
    """The camera above everybody, which moves so that all who are alive are in view."""

    def __init__(self, world: World, history: History, aspect: float) -> None:
        """Work out how the camera moves, for pictures whose width is ``aspect`` times their height."""
        agents, self._frames = history.agents, history.frame
        alive = (agents.present & (agents.health > 0))[..., None]
        some = np.asarray(alive.any(axis=1))
        low = _filled(np.where(alive, agents.position, np.inf).min(axis=1), some)
        high = _filled(np.where(alive, agents.position, -np.inf).max(axis=1), some)
        if history.target is not None:
            low, high = np.minimum(low, history.target), np.maximum(high, history.target)
        low, high = widened(low, high)
        steps = _steps(history, GLIDE)
        every = max(1, steps // 3)  # rows for which the camera is fitted; it glides in between
        self._rows = np.unique([*range(0, len(low), every), len(low) - 1])
        lows, highs = -_greatest(-low, steps), _greatest(high, steps)
        boxes = [running_mean(corners, steps)[self._rows] for corners in (lows, highs)]
        views = [view_above(low, high, aspect) for low, high in zip(*boxes, strict=True)]
        self._targets = np.array([view.target for view in views])
        self._eyes = over_map(world, np.array([view.eye for view in views]), self._targets)

    def at(self, moment: InterpolatedState) -> Camera:
        """Return the camera at a moment."""
        frames = self._frames[self._rows]
        eye, target = (
            np.array([np.interp(moment.frame, frames, places[:, axis]) for axis in range(3)])
            for places in (self._eyes, self._targets)
        )
        return camera_above(eye, target)


def widened(low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """Return (…, 3) and (…, 3) m, the corners of what is to be in view of those between two corners."""
    level = np.array([1.0, 0.0, 1.0])
    around = np.maximum(MARGIN, (LEAST_EXTENT - (high - low)) / 2) * level
    return low - around, high + around + [0.0, ROOF, 0.0]


def view_above(low: Vector, high: Vector, aspect: float) -> Overview:
    """Return the view from above in which a box fits into pictures of an aspect."""
    slope = float(np.tan(np.radians(ANGLE / 2)))
    return fitted(box_corners(low, high), slope, slope / aspect, FROM)


def camera_above(eye: Vector, target: Vector) -> Camera:
    """Return the camera at a place (3,) m that looks at another."""
    x, y, z = (target - eye).tolist()
    yaw, pitch = np.degrees(np.arctan2(x, z)), np.degrees(np.arctan2(-y, np.hypot(x, z)))
    return Camera(eye, float(yaw), float(pitch), None, ABOVE_FAR)


def over_map(world: World, eyes: NDArray[np.float64], targets: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (N, 3) m eyes over the map, as far from the targets; from beside it, none of it is seen."""
    far = np.linalg.norm(eyes - targets, axis=1)
    edge = -world.corner - EDGE
    x, z = np.clip(eyes[:, 0], -edge[0], edge[0]), np.clip(eyes[:, 2], -edge[1], edge[1])
    level = np.hypot(x - targets[:, 0], z - targets[:, 2])
    above = np.sqrt(np.maximum(far * far - level * level, (0.5 * far) ** 2))
    return np.stack([x, targets[:, 1] + above, z], axis=-1)


def _shoulder(yaw: float) -> Vector:
    """Return (3,) m from the soles to the point that the camera behind an agent looks past."""
    right = directions(np.array(yaw + 90.0), np.array(0.0))
    return np.asarray(SHOULDER * right + [0.0, HEAD, 0.0])


def _steps(history: History, seconds: float) -> int:
    """Return how many steps of a match take some seconds."""
    frames = float(history.frame[-1]) / max(1, len(history.frame) - 1)
    return max(1, round(seconds * FRAMES_PER_SECOND / max(1.0, frames)))


def _greatest(values: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """Return the running maximum of values over time, their first axis."""
    return np.asarray(windows_around(values, steps).max(axis=-1))


def _filled(values: NDArray[np.float64], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return (T, 3) values in which rows that are not known repeat the last one before that is."""
    rows = np.maximum.accumulate(np.where(known.ravel(), np.arange(len(values)), 0))
    filled = values[rows]
    return np.where(np.isfinite(filled), filled, 0.0)
