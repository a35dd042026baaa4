"""The convex solids that houses, trees and rocks are made of, one by one or many at once."""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import Kind, Solid, convex_solid, set_plane, write_plane

Corner = tuple[float, float, float]  # m: across, up, along
Number = TypeVar("Number", float, NDArray[np.float64])

# The corners of a box are numbered by the bits (along, up, across): 0 = low, 1 = high.
BOX_FACES = np.array([[0, 1, 4], [2, 3, 6], [0, 1, 2], [4, 5, 6], [0, 2, 4], [1, 3, 5]])
# The same for a roof's eaves; corners 8 and 9 are the ends of its ridge.
ROOF_FACES = np.array([[0, 1, 4], [0, 2, 4], [1, 3, 5], [0, 1, 2], [4, 5, 6], [2, 6, 8], [3, 7, 8]])
HIP_FACES = np.array([[2, 3, 8], [6, 7, 9]])
MAX_SIDES, MAX_RINGS = 8, 4
KINDS = tuple(Kind)


class Rectangle(NamedTuple):
    """A rectangle in the axes of a pose, m: across from left to right, along from back to front."""

    left: float
    back: float
    right: float
    front: float

    @property
    def area(self) -> float:
        """In m²."""
        return (self.right - self.left) * (self.front - self.back)

    def holds(self, across: NDArray[np.float64], along: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which of some points in m lie between its edges."""
        return (across > self.left) & (across < self.right) & (along > self.back) & (along < self.front)


class Pose(NamedTuple):
    """A position and a yaw; the axes of a pose are *across* (to its right) and *along* (ahead)."""

    x: float  # m
    z: float  # m
    sine: float  # of the yaw
    cosine: float

    def outside(self, across: float, along: float) -> tuple[float, float]:
        """Return x and z of a point given in the axes of the pose."""
        return (
            self.x + across * self.cosine + along * self.sine,
            self.z - across * self.sine + along * self.cosine,
        )

    def inside(self, x: Number, z: Number) -> tuple[Number, Number]:
        """Return a point of the map, or several, in the axes of the pose."""
        east, north = x - self.x, z - self.z
        return east * self.cosine - north * self.sine, east * self.sine + north * self.cosine


def pose(x: float, z: float, yaw: float) -> Pose:
    """Return the pose at (x, z) in m that looks along a yaw in degrees."""
    return Pose(x, z, sine(yaw), cosine(yaw))


def box(kind: Kind, where: Pose, low: Corner, high: Corner) -> Solid:
    """Make a box from two opposite corners in the axes of a pose; up is the height on the map."""
    return convex_solid(kind, _box_corners(where, low, high), BOX_FACES)


def boxes(kinds: Sequence[Kind], where: Pose, corners: Sequence[tuple[float, ...]]) -> list[Solid]:
    """Make many boxes at once, each from its least and its greatest corner in the axes of a pose.

    Args:
        kinds: (N,) the kind of each box.
        corners: (N, 6) m, the least corner and the greatest of each box; up is the height on the map.
    """
    planes, low, high = _boxes(where, np.array(corners, np.float64).reshape(-1, 6))
    return [Solid(kind, planes[box], low[box], high[box]) for box, kind in enumerate(kinds)]


@array_kernel
def _boxes(
    where: Pose, corners: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the (N, 6, 4) planes of boxes, and the (N, 3) least and greatest corners around them."""
    count = corners.shape[0]
    planes, low, high = np.empty((count, 6, 4)), np.empty((count, 3)), np.empty((count, 3))
    across_x, across_z, along_x, along_z = where.cosine, -where.sine, where.sine, where.cosine
    across_0 = across_x * where.x + across_z * where.z
    along_0 = along_x * where.x + along_z * where.z
    for box in range(count):
        left, bottom, back, right, top, front = corners[box]
        set_plane(planes[box, 0], -across_x, 0.0, -across_z, -across_0 - left)
        set_plane(planes[box, 1], across_x, 0.0, across_z, across_0 + right)
        set_plane(planes[box, 2], 0.0, -1.0, 0.0, -bottom)
        set_plane(planes[box, 3], 0.0, 1.0, 0.0, top)
        set_plane(planes[box, 4], -along_x, 0.0, -along_z, -along_0 - back)
        set_plane(planes[box, 5], along_x, 0.0, along_z, along_0 + front)
        low[box, 0], low[box, 1], low[box, 2] = np.inf, bottom, np.inf
        high[box, 0], high[box, 1], high[box, 2] = -np.inf, top, -np.inf
        for across in (left, right):
            for along in (back, front):
                x = where.x + across * across_x + along * along_x
                z = where.z + across * across_z + along * along_z
                low[box, 0], high[box, 0] = min(low[box, 0], x), max(high[box, 0], x)
                low[box, 2], high[box, 2] = min(low[box, 2], z), max(high[box, 2], z)
    return planes, low, high


def pitched_roof(
    kind: Kind, where: Pose, low: Corner, high: Corner, eaves: float, hips: tuple[float, float]
) -> Solid:
    """Make a pitched roof whose ridge runs along the pose.

    Args:
        low: Its least corner, in the axes of the pose.
        high: Its greatest corner; the ridge is at this height.
        eaves: m, height of the vertical band at the eaves. Without it, collision against the pushed-out faces
            would keep bodies far away from the sharp edge.
        hips: m, distance of the ridge's ends from the back and the front end; 0 is a gable.
    """
    corners = np.empty((10, 3))
    corners[:8] = _box_corners(where, low, (high[0], low[1] + eaves, high[2]))
    middle = (low[0] + high[0]) * 0.5
    for row, along in ((8, low[2] + hips[0]), (9, high[2] - hips[1])):
        x, z = where.outside(middle, along)
        corners[row] = (x, high[1], z)
    faces = [*ROOF_FACES]
    faces += [end for hip, end in zip(hips, HIP_FACES, strict=True) if hip > 0.0]
    return convex_solid(kind, corners, np.array(faces))


def lean_to(kind: Kind, where: Pose, low: Corner, high: Corner, eaves: float) -> Solid:
    """Make a roof of one slope, highest along its back.

    Args:
        low: Its least corner, in the axes of the pose.
        high: Its greatest corner, the height of its back.
        eaves: m, height of its front above ``low``.
    """
    corners = _box_corners(where, low, high)
    corners[[6, 7], 1] = low[1] + eaves
    return convex_solid(kind, corners, BOX_FACES)


def _box_corners(where: Pose, low: Corner, high: Corner) -> NDArray[np.float64]:
    corners = []
    for along in (low[2], high[2]):
        plan = [where.outside(across, along) for across in (low[0], high[0])]
        corners += [(x, up, z) for up in (low[1], high[1]) for x, z in plan]
    return np.array(corners)


def polygon(sides: int, turn: float) -> NDArray[np.float64]:
    """Return the corners (sides, 2) in m of a regular polygon of radius 1, its first at a yaw in degrees."""
    yaws = [turn + corner * 360.0 / sides for corner in range(sides)]
    return np.array([(sine(yaw), cosine(yaw)) for yaw in yaws])


def stack(
    kind: Kind, x: float, z: float, outline: NDArray[np.float64], rings: Sequence[tuple[float, float]]
) -> Solid:
    """Make a solid from scaled copies of one outline above each other: a prism, frustum, pyramid or spindle.

    Args:
        x: m, of its axis.
        outline: (N, 2) corners of a convex polygon around (0, 0).
        rings: Height in m and scale of the outline for each ring, upwards. The profile must be convex
            (each scale at least that of the straight line between its neighbours); the first and the last
            scale may be 0, a tip.
    """
    sides, levels = len(outline), np.array(rings)
    corners = np.empty((len(rings), sides, 3))
    corners[:, :, 0] = x + outline[None, :, 0] * levels[:, 1, None]
    corners[:, :, 1] = levels[:, 0, None]
    corners[:, :, 2] = z + outline[None, :, 1] * levels[:, 1, None]
    faces = _stack_faces(sides, tuple(scale == 0.0 for _, scale in rings))
    return convex_solid(kind, corners.reshape(-1, 3), faces)


@lru_cache(maxsize=64)
def _stack_faces(sides: int, tips: tuple[bool, ...]) -> NDArray[np.int64]:
    faces = []
    for ring in range(len(tips) - 1):
        lower, upper = ring * sides, (ring + 1) * sides
        for corner in range(sides):
            following = (corner + 1) % sides
            if tips[ring]:
                faces.append((lower, upper + corner, upper + following))
            else:
                faces.append((lower + corner, lower + following, upper + corner))
    last = (len(tips) - 1) * sides
    faces += [(end, end + 1, end + 2) for end, tip in ((0, tips[0]), (last, tips[-1])) if not tip]
    return np.array(faces)


class RingStacks(NamedTuple):
    """The shapes of N solids, each as ``shapes.stack`` makes it."""

    kind: NDArray[np.int64]  # (N,) a Kind
    axis: NDArray[np.float64]  # (N, 2) m, x and z
    sides: NDArray[np.int64]  # (N,) corners of the outline
    outline: NDArray[np.float64]  # (N, 8, 2) m, corners of a convex polygon around (0, 0)
    levels: NDArray[np.int64]  # (N,) rings
    rings: NDArray[np.float64]  # (N, 4, 2) height in m and scale of the outline, upwards; a convex profile


def allocate_ring_stacks(count: int) -> RingStacks:
    """Return zeros for the shapes of ``count`` solids."""
    return RingStacks(
        np.zeros(count, np.int64),
        np.zeros((count, 2)),
        np.zeros(count, np.int64),
        np.zeros((count, MAX_SIDES, 2)),
        np.zeros(count, np.int64),
        np.zeros((count, MAX_RINGS, 2)),
    )


def solids_of(stacks: RingStacks, count: int) -> list[Solid]:
    """Return the first ``count`` shapes as solids."""
    start, planes, low, high = _build(stacks, count)
    kinds, ends = stacks.kind.tolist(), start.tolist()
    return [
        Solid(KINDS[kinds[row]], planes[ends[row] : ends[row + 1]], low[row], high[row])
        for row in range(count)
    ]


@array_kernel
def _build(
    stacks: RingStacks, count: int
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return where each solid's planes start (N + 1,), all planes (F, 4), and the solids' boxes (N, 3)."""
    start = np.zeros(count + 1, np.int64)
    for row in range(count):
        levels, sides = stacks.levels[row], stacks.sides[row]
        caps = int(stacks.rings[row, 0, 1] > 0.0) + int(stacks.rings[row, levels - 1, 1] > 0.0)
        start[row + 1] = start[row] + (levels - 1) * sides + caps
    planes = np.empty((start[count], 4))
    low, high = np.empty((count, 3)), np.empty((count, 3))
    for row in range(count):
        _write_box(stacks, row, low, high)
        _write_planes(stacks, row, start[row], planes)
    return start, planes, low, high


@kernel
def _corner(stacks: RingStacks, row: int, ring: int, corner: int) -> tuple[float, float, float]:
    height, scale = stacks.rings[row, ring, 0], stacks.rings[row, ring, 1]
    x = stacks.axis[row, 0] + stacks.outline[row, corner, 0] * scale
    z = stacks.axis[row, 1] + stacks.outline[row, corner, 1] * scale
    return x, height, z


@kernel
def _write_box(stacks: RingStacks, row: int, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
    for axis in range(3):
        low[row, axis], high[row, axis] = np.inf, -np.inf
    for ring in range(stacks.levels[row]):
        for corner in range(stacks.sides[row]):
            place = _corner(stacks, row, ring, corner)
            for axis in range(3):
                low[row, axis] = min(low[row, axis], place[axis])
                high[row, axis] = max(high[row, axis], place[axis])


@kernel
def _write_planes(stacks: RingStacks, row: int, first: int, planes: NDArray[np.float64]) -> None:
    sides, top = stacks.sides[row], stacks.levels[row] - 1
    height = 0.5 * (stacks.rings[row, 0, 0] + stacks.rings[row, top, 0])
    behind = (stacks.axis[row, 0], height, stacks.axis[row, 1])
    written = first
    for ring in range(top):
        is_tip = stacks.rings[row, ring, 1] == 0.0
        for corner in range(sides):
            following = (corner + 1) % sides
            a = _corner(stacks, row, ring, corner)
            b = _corner(stacks, row, ring + 1 if is_tip else ring, following)
            c = _corner(stacks, row, ring + 1, corner)
            write_plane(a, b, c, behind, planes[written])
            written += 1
    if stacks.rings[row, 0, 1] > 0.0:
        set_plane(planes[written], 0.0, -1.0, 0.0, -stacks.rings[row, 0, 0])
        written += 1
    if stacks.rings[row, top, 1] > 0.0:
        set_plane(planes[written], 0.0, 1.0, 0.0, stacks.rings[row, top, 0])
