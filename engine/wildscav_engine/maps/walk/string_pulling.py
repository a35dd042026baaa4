"""String pulling: moving the turns of a path from the graph's nodes as close to corners as a body fits."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import walk_straight
from wildscav_engine.maps.walk.lattice import SPACING
from wildscav_engine.maps.walk.search import LEG_STRIDE, is_straight
from wildscav_engine.motion.collision import Bodies, Point

ROUNDS = 8
LEAST_GAIN = 0.01  # m, a round that shortens the path by less is the last
# m that a turn stays away from its limit, because bodies reach it only to a centimetre
CORNER_CLEARANCE = 0.03
SHARES = (1.0, 0.5, 0.25, 0.125)  # of the distance to the straight line, tried in turn


@array_kernel
def pull_tight(world: World, nobody: Bodies, turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of a walk, (P, 3) m, with each turn moved towards the line between its neighbours.

    Args:
        turns: (P, 3) m, soles; each can be reached by a straight walk from the one before. The ends do not
            move.
    """
    tight = turns.copy()
    for _ in range(ROUNDS):
        gained = 0.0
        for turn in range(1, tight.shape[0] - 1):
            gained += _move_in(world, nobody, tight, turn)
        if gained < LEAST_GAIN:
            break
    return tight


@kernel
def _move_in(world: World, nobody: Bodies, turns: NDArray[np.float64], turn: int) -> float:
    """Move a turn as far as possible in one step; return how many m shorter the path becomes."""
    before, here, after = _point(turns, turn - 1), _point(turns, turn), _point(turns, turn + 1)
    old = _apart(before, here) + _apart(here, after)
    foot_x, foot_z = _nearest_on(before, after, here)
    whole = _apart(here, Point(foot_x, here.y, foot_z))
    for share in SHARES:
        moved = share * whole - CORNER_CLEARANCE
        if moved <= 0.0:
            break
        furthest = _turn_at(world, nobody, before, here, after, foot_x, foot_z, share)
        if not furthest.y < np.inf:
            continue
        there = _turn_at(world, nobody, before, here, after, foot_x, foot_z, moved / whole)
        gain = old - _apart(before, there) - _apart(there, after)
        if there.y < np.inf and gain > 0.0:
            turns[turn, 0], turns[turn, 1], turns[turn, 2] = there.x, there.y, there.z
            return gain
    return 0.0


@kernel
def _turn_at(
    world: World,
    nobody: Bodies,
    before: Point,
    here: Point,
    after: Point,
    foot_x: float,
    foot_z: float,
    share: float,
) -> Point:
    """Return a turn moved towards a foot point by a share of the distance; its height is inf if it cannot."""
    x, z = here.x + share * (foot_x - here.x), here.z + share * (foot_z - here.z)
    if max(abs(x - before.x), abs(z - before.z)) < LEG_STRIDE:
        return Point(x, np.inf, z)
    height = walk_straight(world, nobody, before, x, z, SPACING)
    if not abs(height) < np.inf:
        return Point(x, np.inf, z)
    there = Point(x, height, z)
    if is_straight(world, nobody, before, there) and is_straight(world, nobody, there, after):
        return there
    return Point(x, np.inf, z)


@kernel
def _point(turns: NDArray[np.float64], turn: int) -> Point:
    return Point(turns[turn, 0], turns[turn, 1], turns[turn, 2])


@kernel
def _apart(one: Point, other: Point) -> float:
    """Return the horizontal distance in m between two points."""
    return float(np.sqrt((other.x - one.x) * (other.x - one.x) + (other.z - one.z) * (other.z - one.z)))


@kernel
def _nearest_on(start: Point, end: Point, here: Point) -> tuple[float, float]:
    """Return x and z in m of the point between two others that is nearest to a third, seen from above."""
    east, north = end.x - start.x, end.z - start.z
    length = east * east + north * north
    share = ((here.x - start.x) * east + (here.z - start.z) * north) / length if length > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    return start.x + share * east, start.z + share * north
