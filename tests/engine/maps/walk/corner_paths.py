"""Walls on level ground, and the exact length of the shortest path among them, from corner to corner."""

import math
from collections.abc import Sequence

import numpy as np
from tests.builders import box

from wildscav_engine.geometry.world import Solid

Rectangle = tuple[float, float, float, float]  # m: least x and z, greatest x and z


def rectangles(seed: int) -> list[Rectangle]:
    """Return fourteen walls and blocks on 40 × 40 m."""
    random = np.random.default_rng(seed)
    sides = random.uniform(0.3, 2.0, (14, 2))
    sides[np.arange(14), random.integers(0, 2, 14)] = random.uniform(0.5, 10.0, 14)
    middles = random.uniform(-17.0, 17.0, (14, 2))
    return [tuple(row) for row in np.concatenate([middles - sides / 2, middles + sides / 2], axis=1).tolist()]


def cuts(start: Sequence[float], end: Sequence[float], block: Rectangle) -> bool:
    """Return whether a straight line leads through a rectangle; touching it is allowed."""
    enter, leave = 0.0, 1.0
    for axis in range(2):
        way, low, high = end[axis] - start[axis], block[axis], block[axis + 2]
        if abs(way) < 1e-12:
            if start[axis] <= low + 1e-9 or start[axis] >= high - 1e-9:
                return False
            continue
        first, second = sorted(((low - start[axis]) / way, (high - start[axis]) / way))
        enter, leave = max(enter, first), min(leave, second)
    return leave - enter > 1e-9


def shortest_by_corners(
    blocks: list[Rectangle], start: Sequence[float], end: Sequence[float], room: float
) -> float:
    """Return the length of the shortest path from corner to corner that stays ``room`` m off the blocks."""
    wide = [(x - room, z - room, to_x + room, to_z + room) for x, z, to_x, to_z in blocks]
    corners = [(x, z) for block in wide for x in block[::2] for z in block[1::2] if max(abs(x), abs(z)) < 19]
    points = [tuple(start), tuple(end), *corners]
    lengths, done = dict.fromkeys(range(len(points)), math.inf) | {0: 0.0}, set()
    while (at := min(lengths.keys() - done, key=lambda node: lengths[node])) != 1:
        done.add(at)
        if lengths[at] == math.inf:
            return math.inf
        for other in lengths.keys() - done:
            length = lengths[at] + math.dist(points[at], points[other])
            if length < lengths[other] and not any(cuts(points[at], points[other], block) for block in wide):
                lengths[other] = length
    return lengths[1]


def walls(blocks: list[Rectangle]) -> list[Solid]:
    """Return rectangles as solids 3 m high."""
    return [box((x, 0, z), (to_x, 3, to_z)) for x, z, to_x, to_z in blocks]


def free_places(blocks: list[Rectangle], seed: int) -> list[tuple[float, float]]:
    """Return random places 0.8 m or more off all blocks."""
    return [
        (float(x), float(z))
        for x, z in np.random.default_rng(seed).uniform(-18, 18, (60, 2))
        if not any(
            low - 0.8 < x < high + 0.8 and back - 0.8 < z < front + 0.8 for low, back, high, front in blocks
        )
    ]
