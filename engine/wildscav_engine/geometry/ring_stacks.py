"""Building many solids at once from stacked, scaled outlines: trunks, crowns, bushes, rocks."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import Kind, Solid, set_plane, write_plane

MAX_SIDES, MAX_RINGS = 8, 4
KINDS = tuple(Kind)


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
    written = first
    for ring in range(top):
        is_tip = stacks.rings[row, ring, 1] == 0.0
        for corner in range(sides):
            following = (corner + 1) % sides
            a = _corner(stacks, row, ring, corner)
            b = _corner(stacks, row, ring + 1 if is_tip else ring, following)
            c = _corner(stacks, row, ring + 1, corner)
            _write_plane(stacks, row, a, b, c, planes[written])
            written += 1
    if stacks.rings[row, 0, 1] > 0.0:
        set_plane(planes[written], 0.0, -1.0, 0.0, -stacks.rings[row, 0, 0])
        written += 1
    if stacks.rings[row, top, 1] > 0.0:
        set_plane(planes[written], 0.0, 1.0, 0.0, stacks.rings[row, top, 0])


@kernel
def _write_plane(
    stacks: RingStacks,
    row: int,
    a: tuple[float, float, float],
    b: tuple[float, float, float],
    c: tuple[float, float, float],
    plane: NDArray[np.float64],
) -> None:
    """Write the plane through three corners; the axis at half the height lies behind it."""
    height = 0.5 * (stacks.rings[row, 0, 0] + stacks.rings[row, stacks.levels[row] - 1, 0])
    write_plane(a, b, c, (stacks.axis[row, 0], height, stacks.axis[row, 1]), plane)
