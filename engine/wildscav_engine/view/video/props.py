"""What a video shows besides agents and boxes: shots, the dead, the target, and the edge of the safe zone."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.rendering.dynamic_objects import DynamicObjects
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.rendering.tracing.solids import NO_OWNER, Solids
from wildscav_engine.view.recording.camera_poses import lay_on_ground
from wildscav_engine.view.recording.colors import DEAD, NEXT_ZONE, SHOT, TARGET, ZONE
from wildscav_engine.view.recording.coordinates import directions
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.moments import InterpolatedState

Vector = NDArray[np.float64]

TRACER_FRAMES = 7  # for which the way of a shot can be seen
TRACER = 0.8  # pixels, half of its thickness, however far it is
TRACER_START, TRACER_PART = 1.0, 1.6  # m from the muzzle; how many times as far each part of it reaches
MUZZLE = (0.22, 1.32, 0.55)  # m to the right of an agent, above its soles, and ahead of it
BEACON = 0.18, 14.0  # m, half the thickness of the pole at the target, and half its height
POSTS, POST = 72, (0.12, 4.0)  # around the safe zone; m, half the thickness of each, and half its height
FALLEN = ((-0.45, 0.34, 0.24, 0.46), (0.42, 0.24, 0.17, 0.44), (-1.02, 0.13, 0.16, 0.14))
# Parts of a body on the ground: the place of its middle along the body, half its width, height and length.
UP = np.array([0.0, 1.0, 0.0])
SIGNS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float64)


class Block(NamedTuple):
    """A box that may be turned in any way."""

    middle: Vector  # (3,) m
    axes: NDArray[np.float64]  # (3, 3) unit vectors: across, up and along
    half: tuple[float, float, float]  # m along each axis
    color: tuple[float, float, float]  # red, green, blue 0-255


def with_props(
    objects: DynamicObjects,
    world: World,
    history: History,
    moment: InterpolatedState,
    eye: Vector,
    pixel: float,
) -> DynamicObjects:
    """Return dynamic objects together with everything else that is there at a moment.

    Args:
        eye: (3,) m, where the camera is.
        pixel: m, the size of its pixels at a distance of 1 m.
    """
    blocks = [
        *_tracers(history, moment, eye, pixel),
        *_fallen(history, moment),
        *_beacon(history),
        *_posts(world, history, moment),
    ]
    if not blocks:
        return objects
    solids = _joined(objects.solids, _solids_of(blocks))
    color = np.concatenate([objects.color, [block.color for block in blocks]])
    return DynamicObjects(solids, np.append(objects.instance, np.zeros(len(blocks), np.int32)), color)


def muzzle_of(position: Vector, yaw: float) -> Vector:
    """Return (3,) m where the shots of an agent leave its rifle."""
    ahead = directions(np.array(yaw), np.array(0.0))
    across, up, along = MUZZLE
    return np.asarray(position + across * np.cross(UP, ahead) + up * UP + along * ahead)


def _tracers(history: History, moment: InterpolatedState, eye: Vector, pixel: float) -> Iterator[Block]:
    """Yield the ways of the latest shots, in parts of which each is about as thick in the picture."""
    agents, row = history.agents, moment.row
    while row > 0 and moment.frame - history.frame[row] < TRACER_FRAMES:
        for seat in np.nonzero(agents.fired[row])[0].tolist():
            start = muzzle_of(agents.position[row, seat], float(agents.yaw[row, seat]))
            way = agents.shot_end[row, seat] - start
            length = float(np.linalg.norm(way))
            yield from _parts(start, way / max(length, 1e-9), length, eye, pixel)
        row -= 1


def _parts(start: Vector, way: Vector, length: float, eye: Vector, pixel: float) -> Iterator[Block]:
    first = TRACER_START
    while first < length:
        # Parts end where others begin to be nearer, so that none is much thicker at one end.
        nearest = float(np.linalg.norm(start + first * way - eye))
        last = min(length, first + max(2.0, (TRACER_PART - 1.0) * nearest))
        middle = start + (first + last) / 2 * way
        thin = TRACER * pixel * float(np.linalg.norm(middle - eye))
        yield Block(middle, _axes_along(way), (thin, thin, (last - first) / 2), SHOT)
        first = last


def _fallen(history: History, moment: InterpolatedState) -> Iterator[Block]:
    there = history.agents.present[moment.row] & ~moment.alive
    for seat in np.nonzero(there)[0].tolist():
        axes = _axes_along(directions(moment.yaw[seat], np.array(0.0)))
        own, grey = np.array(of_seat(history.team_of(seat))), np.array(DEAD)
        red, green, blue = (0.35 * own + 0.65 * grey).tolist()
        for place, wide, high, long in FALLEN:
            middle = moment.position[seat] + high * UP + place * axes[2]
            yield Block(middle, axes, (wide, high, long), (red, green, blue))


def _beacon(history: History) -> Iterator[Block]:
    if history.target is not None:
        thin, high = BEACON
        yield Block(history.target + high * UP, np.eye(3), (thin, high, thin), TARGET)


def _posts(world: World, history: History, moment: InterpolatedState) -> Iterator[Block]:
    """Yield the posts around the safe zone, and white ones around the circle that it shrinks to."""
    if history.zone is None:
        return
    zone = history.zone[moment.row]
    for (x, z, radius), color, count in ((zone[:3], ZONE, POSTS), (zone[3:], NEXT_ZONE, POSTS // 2)):
        angles = 2 * np.pi * np.arange(count) / count
        feet = np.stack([x + radius * np.sin(angles), 0 * angles, z + radius * np.cos(angles)], axis=-1)
        lay_on_ground(world, 0.0, feet)
        thin, high = POST
        for foot in feet[(np.abs(feet[:, [0, 2]]) < -world.corner).all(axis=1)]:
            yield Block(foot + high * UP, np.eye(3), (thin, high, thin), color)


def _axes_along(way: Vector) -> NDArray[np.float64]:
    """Return (3, 3) unit vectors across, above and along a unit vector."""
    across = np.cross(UP, way)
    length = float(np.linalg.norm(across))
    across = across / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    return np.stack([across, np.cross(way, across), way])


def _solids_of(blocks: list[Block]) -> Solids:
    count = len(blocks)
    middle = np.array([block.middle for block in blocks])
    axes, half = np.array([block.axes for block in blocks]), np.array([block.half for block in blocks])
    corners = middle[:, None] + (SIGNS * half[:, None]) @ axes
    normals = np.concatenate([-axes, axes], axis=1)
    offsets = (normals * middle[:, None]).sum(axis=2) + np.tile(half, 2)
    return Solids(
        np.full(count, int(Kind.AGENT), np.int8),
        np.full(count, NO_OWNER, np.int32),
        corners.min(axis=1),
        corners.max(axis=1),
        np.arange(count + 1, dtype=np.int64) * 6,
        np.concatenate([normals, offsets[..., None]], axis=2).reshape(-1, 4),
        np.arange(count + 1, dtype=np.int64) * 8,
        corners.reshape(-1, 3),
    )


def _joined(first: Solids, second: Solids) -> Solids:
    """Return the solids of both."""
    joined = {
        name: np.concatenate([getattr(first, name), getattr(second, name)])
        for name in ("kind", "owner", "low", "high", "faces", "corners")
    }
    for name in ("face_start", "corner_start"):
        start, more = getattr(first, name), getattr(second, name)
        joined[name] = np.concatenate([start, start[-1] + more[1:]])
    return Solids(**joined)
