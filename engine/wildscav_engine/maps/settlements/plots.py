"""Finding plots for houses: dry, fairly level ground, clear of everything built so far."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.shapes import Pose
from wildscav_engine.maps.ground.terrain import (
    LEVEL_MARGIN,
    LONGEST_JOIN,
    Terrain,
    distance_to_footprint,
    room_of_join,
)
from wildscav_engine.maps.settlements.footprints import (
    Site,
    farthest_out,
    footprints_of,
    gap_between,
    half_diagonal,
    heights_under,
    placed_footprints,
)
from wildscav_engine.specs.map_spec import MapConfig

EDGE_MARGIN = 3.0  # m between a house and the edge of the map
PLACED_MARGIN = 3.0  # m between a house and a placement
LANE_MARGIN = 3.2  # m between a house and the axis of a street that it does not face
SHORE_MARGIN = 0.25  # m that the natural ground under a house lies above the water
STEEPEST_GROUND = 5.0  # m, greatest difference of natural heights under a house
STEEPEST_JOIN = 0.3  # m up per m between the level grounds of two houses that are near each other
JOIN_REACH = 24.0  # m between their level grounds; beyond, the join may be steeper
SHARED_LEVEL = 2.0 * LEVEL_MARGIN + 0.5  # m between two houses; nearer ones share one level
DEEPEST_CUT = 1.5  # m between the level of a house and the mean height of the ground

Footprint = NDArray[np.float64]  # (6,)
Footprints = NDArray[np.float64]  # (N, 6)
Points = NDArray[np.float64]  # (N, 2) m, of lanes
Levels = NDArray[np.float64]  # (N,) m
Place = tuple[float, float, float]  # x and z in m, and a yaw in degrees


class Plots:
    """The ground of a map with the houses placed on it so far."""

    def __init__(
        self, config: MapConfig, terrain: Terrain, fixed: Sequence[Site], most: int, avoided: Sequence[Site]
    ) -> None:
        """Start with ``fixed`` houses and sites to avoid; at most ``most`` more houses can be placed."""
        self.terrain = terrain
        self.sites: list[Site] = []
        self._placed = np.concatenate([placed_footprints(config), footprints_of(avoided)])
        self._lanes = np.zeros((0, 2))
        self._footprints = np.zeros((len(fixed) + most, 6))
        self._grounds = np.zeros(len(fixed) + most)
        self._count = len(fixed)
        self._footprints[: len(fixed)] = footprints_of(fixed)
        self._grounds[: len(fixed)] = [site.ground for site in fixed]

    def keep_off(self, points: Points) -> None:
        """Keep further houses away from points (N, 2) in m of a street's axis."""
        self._lanes = np.concatenate([self._lanes, points])

    def is_taken(self, x: float, z: float, margin: float) -> bool:
        """Return whether a house or a placement is nearer to a point than a margin in m."""
        taken = _is_near(self._footprints[: self._count], x, z, margin)
        return taken or _is_near(self._placed, x, z, margin)

    def place_house(self, places: Sequence[Place], size: tuple[float, float], gap: float) -> int:
        """Place a house of a size in m at the first of some places where it is ``gap`` m from all others.

        It returns the number of the place; -1 if it fits nowhere.
        """
        rows = np.empty((len(places), 6))
        rows[:, 4:] = size[0] * 0.5, size[1] * 0.5
        for number, (x, z, yaw) in enumerate(places):
            rows[number, :4] = x, z, sine(yaw), cosine(yaw)
        others, grounds = self._footprints[: self._count], self._grounds[: self._count]
        number, ground = _first_fit(self.terrain, rows, others, grounds, self._placed, self._lanes, gap)
        if number >= 0:
            self._footprints[self._count], self._grounds[self._count] = rows[number], ground
            self._count += 1
            x, z, sine_of_yaw, cosine_of_yaw = rows[number, :4].tolist()
            self.sites.append(Site(Pose(x, z, sine_of_yaw, cosine_of_yaw), places[number][2], size, ground))
        return int(number)


@kernel
def _first_fit(
    terrain: Terrain,
    rows: Footprints,
    others: Footprints,
    grounds: Levels,
    placed: Footprints,
    lanes: Points,
    gap: float,
) -> tuple[int, float]:
    """Return the first footprint on which a house can stand, and its level in m; -1 if there is none."""
    for number in range(rows.shape[0]):
        footprint = rows[number]
        if farthest_out(footprint) > -terrain.corner[0] - EDGE_MARGIN:
            continue
        if not _is_clear(footprint, others, gap) or not _is_clear(footprint, placed, PLACED_MARGIN):
            continue
        if _is_on_lane(footprint, lanes):
            continue
        ground = level_for(terrain, footprint, others, grounds)
        if ground > -np.inf:
            return number, ground
    return -1, -np.inf


@kernel
def _is_clear(footprint: Footprint, others: Footprints, gap: float) -> bool:
    for other in range(others.shape[0]):
        if _may_meet(footprint, others[other], gap) and gap_between(footprint, others[other]) < gap:
            return False
    return True


@kernel
def _may_meet(one: Footprint, other: Footprint, gap: float) -> bool:
    """Return whether the circles around two footprints are nearer than a gap: a cheap first test."""
    reach = half_diagonal(one) + half_diagonal(other) + gap
    east, north = one[0] - other[0], one[1] - other[1]
    return bool(east * east + north * north < reach * reach)


@kernel
def _is_on_lane(footprint: Footprint, lanes: Points) -> bool:
    for point in range(lanes.shape[0]):
        if distance_to_footprint(footprint, lanes[point, 0], lanes[point, 1]) < LANE_MARGIN:
            return True
    return False


@kernel
def _is_near(footprints: Footprints, x: float, z: float, margin: float) -> bool:
    near = False
    for row in range(footprints.shape[0]):
        near = near or distance_to_footprint(footprints[row], x, z) < margin
    return near


@kernel
def level_for(terrain: Terrain, footprint: Footprint, others: Footprints, grounds: Levels) -> float:
    """Return the level in m for a house with this footprint, or -inf if the ground does not allow one."""
    lowest, highest, mean = heights_under(terrain, footprint)
    if lowest < terrain.water_level + SHORE_MARGIN or highest - lowest > STEEPEST_GROUND:
        return -np.inf
    ground = mean
    # Houses whose level margins meet share one level.
    for other in range(others.shape[0]):
        if not _may_meet(footprint, others[other], SHARED_LEVEL):
            continue
        if gap_between(footprint, others[other]) < SHARED_LEVEL:
            ground = grounds[other]
    if abs(ground - mean) > DEEPEST_CUT:
        return -np.inf
    for other in range(others.shape[0]):
        if _may_meet(footprint, others[other], LONGEST_JOIN + 2.0 * LEVEL_MARGIN):
            gap = gap_between(footprint, others[other])
            if abs(ground - grounds[other]) > _most_apart(gap - 2.0 * LEVEL_MARGIN):
                return -np.inf
    return ground


@kernel
def _most_apart(apart: float) -> float:
    """Return how much in m the levels of two houses may differ if their margins are ``apart`` m apart."""
    if apart >= JOIN_REACH:
        return room_of_join(apart)
    return min(room_of_join(apart), STEEPEST_JOIN * max(0.0, apart))
