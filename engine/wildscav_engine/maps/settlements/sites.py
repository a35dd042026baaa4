"""Choosing the sites of houses: in towns and hamlets along streets, or on farmsteads far apart."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.compilation.kernel import array_kernel
from wildscav_engine.geometry.segments import nearest_on
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.footprints import (
    Site,
    corner_of,
    footprints_of,
    gap_between,
)
from wildscav_engine.maps.settlements.plots import EDGE_MARGIN, Place, Plots
from wildscav_engine.maps.settlements.streets import (
    SQUARE_DEPTH,
    STATION,
    STREET_WIDTH,
    Street,
    draw_road,
    draw_streets,
    town_center,
)
from wildscav_engine.specs.map_spec import MapConfig

__all__ = ["CLOSE_GAP", "EDGE_MARGIN", "Settlement", "Site", "corner_of", "footprints_of", "gap_between"]

SCATTERED_GAP, CLOSE_GAP = 9.0, 4.0  # m between houses, on farmsteads and in towns
WIDEST_SCATTER = 60.0  # m between farmsteads, if there is enough space
LARGEST_HAMLET = 12  # houses; more may be split into several hamlets
TOWN_APART = 110.0  # m of the map's side for each town
TOWN_CHOICES = 40
SPARE_TOWNS = 3  # additional towns, if one had no space for all its houses
RANDOM_PLACES = 40  # tried at each distance
ATTEMPTS = 3
LANE_STEP = 2  # points of a street for each segment of a lane
LONGEST_PATH = 16.0  # m from a door to a lane
FORECOURT = 8.0  # m that a street continues after its last house

NOWHERE = np.zeros((0, 2))

Size = tuple[float, float]  # m, across and along


class Settlement(NamedTuple):
    """The houses of a map and the lanes between them."""

    sites: list[Site]
    lanes: NDArray[np.float64]  # (L, 4) m, x and z of both ends of each segment of a lane's axis


def settle(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    sizes: Sequence[Size],
    fixed: Sequence[Site] = (),
    avoided: Sequence[Site] = (),
    kept_off: NDArray[np.float64] = NOWHERE,
) -> Settlement:
    """Find sites for houses, and lay the lanes between them.

    Args:
        terrain: Before any ground is levelled.
        sizes: m, of each house.
        fixed: Sites of houses placed before; they are not returned.
        kept_off: (N, 2) m, x and z of points that houses keep off like the axis of a street.

    Returns:
        Sites for as many of the houses, in their order, as fit; and the lanes.
    """
    best = Settlement([], np.zeros((0, 4)))
    for attempt in range(ATTEMPTS):
        dice = RandomStream(seed, Stream.HOUSES, agent=attempt)
        plots = Plots(config, terrain, fixed, len(sizes), avoided)
        plots.keep_off(kept_off)
        if config.density == "high":
            lanes = _build_towns(dice, plots, sizes)
        else:
            lanes = []
            _scatter(dice, plots, sizes)
        _squeeze_in(dice, plots, sizes)
        if attempt == 0 or len(plots.sites) > len(best.sites):
            best = Settlement(plots.sites, _segments(lanes))
        if len(best.sites) == len(sizes):
            break
    return best


def room_for(settled: Callable[[Sequence[Size]], Settlement], sizes: Sequence[Size]) -> int:
    """Return how many of the houses, counted from the first, certainly fit if no more are asked for."""
    asked = len(sizes)
    while (found := len(settled(sizes[:asked]).sites)) != asked:
        asked = found
    return asked


def _segments(lanes: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return (L, 4) the segments of lanes, each given by points (N, 2)."""
    parts = [np.concatenate([points[:-1], points[1:]], axis=1) for points in lanes if len(points) > 1]
    return np.concatenate(parts) if parts else np.zeros((0, 4))


def _build_towns(dice: RandomStream, plots: Plots, sizes: Sequence[Size]) -> list[NDArray[np.float64]]:
    """Build one town after another until all houses are placed; return their lanes."""
    most = max(1, int(-2.0 * plots.terrain.corner[0] / TOWN_APART)) ** 2
    towns = 1
    if len(sizes) > LARGEST_HAMLET:
        towns = min(most, max(1, int(len(sizes) / dice.uniform(9.0, 24.0) + 0.5)))
    centers: list[Place] = []
    lanes: list[NDArray[np.float64]] = []
    for town in range(towns + SPARE_TOWNS):
        left = len(sizes) - len(plots.sites)
        if left == 0:
            break
        share = left
        if town < towns - 1:
            share = min(left, max(3, int(left / (towns - town) * dice.uniform(0.7, 1.5) + 0.5)))
        center = town_center(dice, plots.terrain, 18.0 + 2.2 * min(share, 30), centers, TOWN_CHOICES)
        built = _build_town(dice, plots, sizes, share, center)
        if built:
            road = _road_between(plots, np.concatenate(lanes), np.concatenate(built)) if lanes else None
            built += [] if road is None else [road]
            for lane in built:
                plots.keep_off(lane)
            lanes += built
            centers.append(center)
    return lanes


def _road_between(
    plots: Plots, older: NDArray[np.float64], newer: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return a road from a new town to the nearest lane, as points (N, 2); None if no route is found."""
    east = newer[:, None, 0] - older[None, :, 0]
    north = newer[:, None, 1] - older[None, :, 1]
    start, end = np.unravel_index(int(np.argmin(east * east + north * north)), east.shape)
    return draw_road(plots, tuple(newer[start].tolist()), tuple(older[end].tolist()))


def _build_town(
    dice: RandomStream, plots: Plots, sizes: Sequence[Size], houses: int, center: Place
) -> list[NDArray[np.float64]]:
    """Build ``houses`` houses along the streets of one town; return its lanes, none if no house fits."""
    streets = draw_streets(dice, plots, houses, center)
    for street in streets:
        for points in (street.points, *_sides_of_square(street)):
            plots.keep_off(points)
    slots = _slots(dice, streets, center)
    used: dict[int, list[int]] = {}
    for _ in range(houses):
        size = sizes[len(plots.sites)]
        places = [_fronting(streets[slot.street], slot, size) for slot in slots]
        chosen = plots.place_house(places, size, CLOSE_GAP)
        if chosen < 0:
            break
        used.setdefault(slots[chosen].street, []).append(slots[chosen].station)
        # This house did not fit on slots nearer to the middle; smaller houses may get them in the end.
        slots = [slot for slot in slots if not _is_near_place(streets, slot, plots.sites[-1])]
    return [
        lane for number, stations in used.items() for lane in _lanes_of(streets[number], number, stations)
    ]


class _Slot(NamedTuple):
    """A place for a house at a street."""

    street: int
    station: int
    side: int  # 1: to the right of the street's direction, -1: to the left
    setback: float  # m between the axis of the street and the front
    skew: float  # degrees that the front is turned away from the street


def _slots(dice: RandomStream, streets: list[Street], center: Place) -> list[_Slot]:
    """Return the slots along streets, nearest to the middle of the town first."""
    slots = []
    for number, street in enumerate(streets):
        for station in range(len(street.points)):
            away = street.points[station] - np.array(center[:2])
            on_square = street.square[0] <= station <= street.square[1]
            for side in (-1, 1):
                setback = STREET_WIDTH / 2.0 + dice.uniform(0.0, 1.5) + (SQUARE_DEPTH if on_square else 0.0)
                slot = _Slot(number, station, side, setback, dice.uniform(-4.0, 4.0))
                distance = float(np.sqrt(away[0] * away[0] + away[1] * away[1]))
                slots.append((distance + dice.uniform(0.0, 10.0), slot))
    return [slot for _, slot in sorted(slots)]


def _fronting(street: Street, slot: _Slot, size: Size) -> Place:
    """Return the place of a house of a size that faces its street."""
    x, z = street.points[slot.station].tolist()
    yaw = float(street.yaws[slot.station]) - slot.side * 90.0 + slot.skew
    away = slot.setback + size[1] / 2.0
    return x - away * sine(yaw), z - away * cosine(yaw), yaw


def _is_near_place(streets: list[Street], slot: _Slot, site: Site) -> bool:
    """Return whether a house at a slot would overlap an existing one."""
    x, z, _ = _fronting(streets[slot.street], slot, (8.0, 8.0))
    across, along = site.pose.inside(x, z)
    return abs(across) < site.size[0] / 2.0 + 4.0 and abs(along) < site.size[1] / 2.0 + 4.0


def _lanes_of(street: Street, number: int, stations: list[int]) -> list[NDArray[np.float64]]:
    """Return the axis of a street as far as it has houses, and the sides of its square."""
    forecourt = int(FORECOURT / STATION)
    first = 0 if number else max(0, min(stations) - forecourt)
    last = min(len(street.points) - 1, max(stations) + forecourt)
    chosen = [*range(first, last, LANE_STEP), last]
    return [street.points[chosen], *_sides_of_square(street)]


def _sides_of_square(street: Street) -> list[NDArray[np.float64]]:
    """Return points (N, 2) in m along the houses on both sides of a street's square."""
    start, end = street.square
    if end <= start:
        return []
    rows = list(range(start, end + 1, LANE_STEP))
    yaws = street.yaws[rows].tolist()
    return [
        street.points[rows] + np.array([(across * cosine(yaw), -across * sine(yaw)) for yaw in yaws])
        for across in (1.0 - SQUARE_DEPTH, SQUARE_DEPTH - 1.0)
    ]


def _scatter(dice: RandomStream, plots: Plots, sizes: Sequence[Size]) -> None:
    """Build farmsteads as far apart as the map allows."""
    span = -2.0 * plots.terrain.corner[0]
    gap = min(WIDEST_SCATTER, 0.5 * span / float(np.sqrt(max(1, len(sizes)))))
    for size in sizes:
        while plots.place_house(_random_places(dice, plots), size, max(gap, SCATTERED_GAP)) < 0:
            if gap <= SCATTERED_GAP:
                return
            gap *= 0.8


def _random_places(dice: RandomStream, plots: Plots, count: int = RANDOM_PLACES) -> list[Place]:
    half = -plots.terrain.corner[0] - EDGE_MARGIN - 4.0
    return [
        (dice.uniform(-half, half), dice.uniform(-half, half), dice.uniform(-180.0, 180.0))
        for _ in range(count)
    ]


def _squeeze_in(dice: RandomStream, plots: Plots, sizes: Sequence[Size]) -> None:
    """Place the remaining houses wherever they fit; stop at the first that does not."""
    if len(plots.sites) == len(sizes):
        return
    half = -plots.terrain.corner[0] - EDGE_MARGIN - 4.0
    steps = max(1, min(60, int(half)))
    turn = dice.uniform(0.0, 90.0)
    grid = [half * (2.0 * step / steps - 1.0) for step in range(steps + 1)]
    everywhere = [(x, z, yaw) for z in grid for x in grid for yaw in (0.0, turn)]
    for size in sizes[len(plots.sites) :]:
        for places in (_random_places(dice, plots, 5 * RANDOM_PLACES), everywhere):
            if plots.place_house(places, size, CLOSE_GAP) >= 0:
                break
        else:
            return


@array_kernel
def door_paths(lanes: NDArray[np.float64], doorsteps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (K, 4) m the paths from doorsteps (D, 2) to the nearest lane, for those near one."""
    paths, found = np.zeros((len(doorsteps), 4)), 0
    for door in range(doorsteps.shape[0]):
        x, z = doorsteps[door, 0], doorsteps[door, 1]
        nearest = LONGEST_PATH * LONGEST_PATH
        is_near = False
        for lane in range(lanes.shape[0]):
            to_x, to_z = nearest_on(lanes[lane], x, z)
            away = (to_x - x) * (to_x - x) + (to_z - z) * (to_z - z)
            if away < nearest:
                nearest, is_near = away, True
                paths[found, 0], paths[found, 1], paths[found, 2], paths[found, 3] = x, z, to_x, to_z
        found += 1 if is_near else 0
    return paths[:found].copy()
