"""The hot spot: a rich place that moves, announced to all in advance like the waves of supplies.

It comes to each of its places at a fixed time. The places are random places where agents may start, drawn
independently of each other; with a safe zone, they are still well inside it when the hot spot moves on. At
each place the same number of boxes appears on open ground, with the density exp(-d² / 2r²), where d is the
distance from the place and r the radius of the heat map.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import exponential
from wildscav_engine.arithmetic.random_numbers import Stream, Word, integer_in, uniform
from wildscav_engine.compilation.kernel import array_kernel, kernel
from wildscav_engine.simulation.state import Matches
from wildscav_engine.simulation.systems.zone import zone_planned
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.specs.supply_config import HotSpot

COLUMNS = 3  # of a place in Matches.hot_spots
NONE = np.zeros((0, COLUMNS))
PLACE_TRIES = 1000  # places to try until one is in the safe zone
INSIDE = 10.0  # m between a place and the edge of the safe zone
REACH = 3.0  # radii of the heat map within which boxes lie
BOX_TRIES = 200  # per box


class Place(NamedTuple):
    """A place of the hot spot."""

    number: int  # from 0; -1 before the first one
    x: float  # m
    z: float  # m


def plan_hot_spot(
    config: HotSpot, spawns: NDArray[np.float64], zone: NDArray[np.float64], seed: int
) -> NDArray[np.float64]:
    """Draw (H, 3) the places of a hot spot, as in ``Matches.hot_spots``, from (N, 3) m on a map.

    The phases of the safe zone are (Z, 9) as in ``Matches.zone``.
    """
    rows = np.zeros((config.places, COLUMNS))
    for number in range(config.places):
        comes, leaves = (
            round((config.start + config.interval * turn) * FRAMES_PER_SECOND)
            for turn in (number, number + 1)
        )
        x, _, z = spawns[draw_place(spawns, zone, np.uint64(seed), number, leaves)]
        rows[number] = comes, x, z
    return rows


@kernel
def draw_place(
    spawns: NDArray[np.float64], zone: NDArray[np.float64], seed: Word, number: int, frame: int
) -> int:
    """Return the index of a random place that is inside the safe zone in a frame.

    If none of some tries is, the nearest of them to the zone is returned.
    """
    circle = zone_planned(zone, frame)
    best, nearest = 0, np.inf
    for attempt in range(PLACE_TRIES):
        place = integer_in(0, spawns.shape[0] - 1, seed, Stream.HOT_SPOT, number, 0, attempt)
        dx, dz = spawns[place, 0] - circle.x, spawns[place, 2] - circle.z
        distance = np.sqrt(dx * dx + dz * dz)
        if distance <= circle.radius - INSIDE:
            return place
        if distance < nearest:
            best, nearest = place, distance
    return best


@array_kernel
def choose_around(
    outdoor: NDArray[np.float64], x: float, z: float, radius: float, boxes: int, seed: Word, number: int
) -> NDArray[np.int64]:
    """Return (N,) the indices of the outdoor locations (O, 3) m that get a box around a place (x, z) m.

    They differ. There are fewer than ``boxes`` where there is too little open ground. The radius, m, is the
    standard deviation of the heat map.
    """
    near, count, reach = np.empty(outdoor.shape[0], np.int64), 0, REACH * radius
    squared = np.empty(outdoor.shape[0])
    for location in range(outdoor.shape[0]):
        dx, dz = outdoor[location, 0] - x, outdoor[location, 2] - z
        if dx * dx + dz * dz <= reach * reach:
            near[count], squared[count] = location, dx * dx + dz * dz
            count += 1
    chosen, found = np.empty(boxes, np.int64), 0
    for attempt in range(BOX_TRIES * boxes if count > 0 else 0):
        one = integer_in(0, count - 1, seed, Stream.HOT_SPOT, number, 1, attempt)
        heat = exponential(-squared[one] / (2.0 * radius * radius))
        if near[one] >= 0 and uniform(seed, Stream.HOT_SPOT, number, 2, attempt) < heat:
            chosen[found], near[one] = near[one], -1
            found += 1
            if found == min(boxes, count):
                break
    return chosen[:found]


@kernel
def latest_of(places: NDArray[np.float64], frame: int) -> int:
    """Return the latest of some places in a frame, as in ``Matches.hot_spots``; -1 before the first."""
    number = -1
    while number + 1 < places.shape[0] and places[number + 1, 0] <= frame:
        number += 1
    return number


@kernel
def hot_spot_at(matches: Matches, match: int, frame: int) -> Place:
    """Return the place where the hot spot is in a frame."""
    number = latest_of(matches.hot_spots[match, : matches.places[match]], frame)
    if number < 0:
        return Place(-1, 0.0, 0.0)
    row = matches.hot_spots[match, number]
    return Place(number, row[1], row[2])
