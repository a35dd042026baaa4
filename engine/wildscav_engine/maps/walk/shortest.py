"""The length of the shortest way to a target, which path lengths are compared with (SPL)."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.walk.explore import ARRIVAL, NO_BODIES, move_on
from wildscav_engine.maps.walk.fine_search import Goal, fine_route
from wildscav_engine.maps.walk.graph import NavGraph
from wildscav_engine.maps.walk.lattice import distance, level_distance
from wildscav_engine.maps.walk.paths import Place, find_path, pulled
from wildscav_engine.motion.collision import Bodies, Point

EXACT = 1.005  # times the straight line: a path that is no longer is not searched for a shorter one
STRIDE = 0.1  # m, of walks that look for the place from which the target is reached
FARTHEST_DETOUR = 3.0  # times the straight line, of what is searched where the graph knows no path


def shortest_length(graph: NavGraph, start: Place, target: Place, reach: float) -> float:
    """Return the length in m of the shortest way from a start to where a target is reached.

    It is horizontal, like ``walked``. No way that leaves a body 0.15 m free on each side is more than 2 %
    shorter: a finer grid is searched where the path over the graph is longer than the straight line.

    Args:
        graph: Of the map.
        start: x, y, z in m, soles.
        target: The same.
        reach: m, 3D distance of the soles at which the target is reached.

    Returns:
        The length; that of the straight line if no way is found.
    """
    best = straight_length(graph.world, start, target, reach)
    if best < np.inf:
        return best
    first, goal = np.array(start, np.float64), Goal(np.array(target, np.float64), float(reach), np.inf)
    least = max(0.0, level_distance(first, goal.target) - goal.reach)
    path = find_path(graph, first, goal.target)
    if path is not None:
        leaps = np.array([False, *(leg.leap for leg in path.legs)])
        best = length_to_target(graph.world, path.points, leaps, goal)
    if best <= EXACT * least:
        return best
    bound = best if best < np.inf else FARTHEST_DETOUR * least + FARTHEST_DETOUR
    finer = finer_path(graph, first, goal._replace(bound=bound))
    if finer is not None:
        best = min(best, length_to_target(graph.world, *finer, goal))
    return best if best < np.inf else least


def straight_length(world: World, start: Place, target: Place, reach: float) -> float:
    """Return the length in m of the straight way to where a target is reached; inf if it is blocked.

    Args:
        world: The static world.
        start: x, y, z in m, soles.
        target: The same.
        reach: m, 3D distance of the soles at which the target is reached.
    """
    goal = Goal(np.array(target, np.float64), float(reach), np.inf)
    return length_to_target(world, np.array([start], np.float64), np.zeros(1, np.bool_), goal)


def finer_path(
    graph: NavGraph, start: NDArray[np.float64], goal: Goal
) -> tuple[NDArray[np.float64], NDArray[np.bool_]] | None:
    """Return the path from (3,) m over the fine grid to where the target is reached, None if there is none.

    It is given by its turns, (P, 3) m with the start, and (P,) whether a leap leads to each.
    """
    route = fine_route(graph, start, goal)
    if route is None:
        return None
    places, leapt = route
    turns, leaps = [places[:1]], [np.zeros(1, np.bool_)]
    ends = [*np.flatnonzero(leapt).tolist(), len(places)]
    for at, end in zip([0, *ends], ends, strict=False):
        walk_only = places[at:end]
        if len(walk_only) > 1:
            walk_only = pulled(graph, walk_only, np.arange(len(walk_only), dtype=np.int32))
            turns.append(walk_only[1:])
            leaps.append(np.zeros(len(walk_only) - 1, np.bool_))
        if end < len(places):
            turns.append(places[end : end + 1])
            leaps.append(np.ones(1, np.bool_))
    return np.concatenate(turns), np.concatenate(leaps)


def length_to_target(world: World, turns: NDArray[np.float64], leaps: NDArray[np.bool_], goal: Goal) -> float:
    """Return the length in m of a path as far as the target is reached, which may be before its last turn.

    From each turn, the body may also go straight to the target. It is inf if neither gets there.

    Args:
        turns: (P, 3) m, soles, with the start.
        leaps: (P,) whether a leap leads to each.
    """
    before, best = 0.0, np.inf
    for number, turn in enumerate(turns):
        best = min(
            best, before + walk_until_reached(world, NO_BODIES, turn, goal.target, goal.target, goal.reach)
        )
        if number + 1 == len(turns):
            break
        after = turns[number + 1]
        if not leaps[number + 1]:
            walked = walk_until_reached(world, NO_BODIES, turn, after, goal.target, goal.reach)
            best = min(best, before + walked)
        before += level_distance(turn, after)
    return best


@kernel
def walk_until_reached(
    world: World,
    nobody: Bodies,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    target: NDArray[np.float64],
    reach: float,
) -> float:
    """Return how far in m a body walks from ``start`` straight towards ``end``, of which x and z count.

    It stops as soon as it is within ``reach`` m of the target, in 3D; inf if it never is. Places are (3,) m.
    """
    at = Point(start[0], start[1], start[2])
    apart = distance(at, target)
    if apart <= reach:
        return 0.0
    east, north = end[0] - start[0], end[2] - start[2]
    far = np.sqrt(east * east + north * north)
    moves, gone = int(np.ceil(far / STRIDE)), 0.0
    for done in range(moves):
        at, short, stands = move_on(world, nobody, at, end[0], end[2], moves - done)
        if short > ARRIVAL or not stands:
            return np.inf
        stride, nearer = far / moves, distance(at, target)
        if nearer <= reach:
            return float(gone + stride * (apart - reach) / (apart - nearer))
        gone, apart = gone + stride, nearer
    return np.inf
