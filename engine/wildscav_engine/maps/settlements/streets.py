"""The streets of towns and hamlets: a winding main street, side streets, sometimes a square; and roads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine
from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.plots import Place, Plots

STATION = 2.0  # m between the points of a street
STREET_WIDTH = 8.0  # m between the fronts of its two sides
STREET_APART = 27.0  # m between two streets of a town, away from their junction
EDGE_MARGIN = 11.0  # m between a street and the edge of the map
SHORE_MARGIN = 0.4  # m of a street above the water
STEEPEST_STREET, STEEPEST_ROAD = 0.3, 0.55  # m up per m
SHARPEST_BEND = 0.8  # degrees per m
FRONTAGE = 16.5  # m of a street that a house takes, with the gap to the next
SIDE_STREETS_FROM = 7  # houses
SWAY, SWAY_STEP = 18.0, 6.5  # degrees, amplitude of a road's winding, and its phase per stride
LONGEST_MAIN = 170.0  # m
SQUARE, SQUARE_DEPTH = 13.0, 6.0  # m, half its length along the main street, and its width on each side


class Street(NamedTuple):
    """A street: points along its axis."""

    points: NDArray[np.float64]  # (N, 2) m, x and z
    yaws: NDArray[np.float64]  # (N,) degrees, its direction at each
    square: tuple[int, int]  # index of its first and last point on the square; (0, -1) without one


def draw_streets(dice: RandomStream, plots: Plots, houses: int, center: Place) -> list[Street]:
    """Return the streets of a town for about so many houses, the main street first.

    The main street leads through the center. Streets that are blocked are left out.
    """
    wanted = FRONTAGE * (houses + 1) / 2.0
    length = wanted if houses < SIDE_STREETS_FROM else min(LONGEST_MAIN, 0.6 * wanted + 16.0)
    forth = _walk(dice, plots, center, length * dice.uniform(0.4, 0.6), [])
    back = _walk(dice, plots, (center[0], center[1], center[2] + 180.0), length * 0.5, [])
    places = [(x, z, yaw + 180.0) for x, z, yaw in reversed(back[1:])] + forth
    middle = max(0, len(back) - 1)
    square = (0, -1)
    if houses >= SIDE_STREETS_FROM and dice.uniform() < 0.5:
        reach = int(SQUARE / STATION)
        square = (max(0, middle - reach), min(len(places) - 1, middle + reach))
    streets = [_street(places, square)]
    if houses >= SIDE_STREETS_FROM:
        streets += _side_streets(dice, plots, places, middle, (wanted - length) * 1.25)
    return streets


def _street(places: list[Place], square: tuple[int, int]) -> Street:
    rows = np.array(places, np.float64).reshape(-1, 3)
    return Street(rows[:, :2].copy(), rows[:, 2].copy(), square)


def _side_streets(
    dice: RandomStream, plots: Plots, main: list[Place], middle: int, wanted: float
) -> list[Street]:
    """Branch streets off the main street, on both sides in turn, nearest to the middle first."""
    streets: list[Street] = []
    taken = [main]
    side = 1.0 if dice.uniform() < 0.5 else -1.0
    apart = int(dice.uniform(34.0, 44.0) / STATION)
    first = int(dice.uniform(-8.0, 8.0) / STATION)
    for number in range(16):
        steps = (number + 1) // 2 * (1 if number % 2 else -1)
        station = middle + first + steps * apart // 2
        if wanted <= 0.0:
            break
        if not 0 <= station < len(main):
            continue
        x, z, yaw = main[station]
        start = (x, z, yaw + side * 90.0 + dice.uniform(-14.0, 14.0))
        places = _walk(dice, plots, start, min(dice.uniform(42.0, 74.0), wanted + 24.0), taken)
        side = -side
        if len(places) * STATION >= 24.0:
            taken.append(places)
            streets.append(_street(places, (0, -1)))
            wanted -= len(places) * STATION - STREET_WIDTH
    return streets


def _walk(
    dice: RandomStream, plots: Plots, start: Place, length: float, streets: list[list[Place]]
) -> list[Place]:
    """Return the places along a winding street until it is ``length`` m long or something blocks it.

    It stays well away from other streets, except near its start.
    """
    terrain = plots.terrain
    x, z, yaw = start
    bend = dice.uniform(-SHARPEST_BEND, SHARPEST_BEND)
    places = [start]
    height = height_at(terrain, x, z)
    for station in range(1, int(length / STATION) + 1):
        if station % 10 == 0:
            bend = max(-SHARPEST_BEND, min(SHARPEST_BEND, bend + dice.uniform(-0.6, 0.6)))
        yaw += bend * STATION
        x, z = x + STATION * sine(yaw), z + STATION * cosine(yaw)
        if not _is_free(plots, x, z) or _comes_near(streets, start, x, z):
            break
        before, height = height, height_at(terrain, x, z)
        if height < terrain.water_level + SHORE_MARGIN or abs(height - before) > STEEPEST_STREET * STATION:
            break
        places.append((x, z, yaw))
    return places


def _is_free(plots: Plots, x: float, z: float) -> bool:
    """Return whether a place is far enough from the map's edge and its houses for a street."""
    half = -plots.terrain.corner[0] - EDGE_MARGIN
    return max(abs(x), abs(z)) <= half and not plots.is_taken(x, z, STREET_WIDTH / 2.0)


def _comes_near(streets: list[list[Place]], start: Place, x: float, z: float) -> bool:
    """Return whether a place is too near to another street, except near the start."""
    away = (x - start[0]) * (x - start[0]) + (z - start[1]) * (z - start[1])
    limit = min(STREET_APART * STREET_APART, 0.5 * away)
    return any(
        (x - other_x) * (x - other_x) + (z - other_z) * (z - other_z) < limit
        for street in streets
        for other_x, other_z, _ in street[::3]
    )


def draw_road(
    plots: Plots, start: tuple[float, float], end: tuple[float, float]
) -> NDArray[np.float64] | None:
    """Return points (N, 2) in m of a road over dry and gentle ground; None if no route is found."""
    x, z = start
    points = [start]
    stride = 2.0 * STATION
    for step in range(int(2.0 * (abs(end[0] - x) + abs(end[1] - z)) / stride) + 8):
        if (end[0] - x) * (end[0] - x) + (end[1] - z) * (end[1] - z) < 4.0 * stride * stride:
            return np.array([*points, end], np.float64)
        towards = arctangent(end[0] - x, end[1] - z) + SWAY * sine(SWAY_STEP * step)
        onward = _onward(plots, x, z, towards, stride)
        if onward is None:
            return None
        x, z = onward
        points.append(onward)
    return None


def _onward(plots: Plots, x: float, z: float, towards: float, stride: float) -> tuple[float, float] | None:
    """Return the next point of a road, as near to the direction ``towards`` in ° as the ground allows."""
    terrain = plots.terrain
    height = height_at(terrain, x, z)
    for turn in (0.0, 20.0, -20.0, 40.0, -40.0, 65.0, -65.0, 95.0, -95.0):
        to_x, to_z = x + stride * sine(towards + turn), z + stride * cosine(towards + turn)
        there = height_at(terrain, to_x, to_z)
        is_dry = there >= terrain.water_level + SHORE_MARGIN
        if is_dry and abs(there - height) <= STEEPEST_ROAD * stride and _is_free(plots, to_x, to_z):
            return to_x, to_z
    return None


@kernel
def height_at(terrain: Terrain, x: float, z: float) -> float:
    """Return the height in m of the ground at a place, interpolated between the corners of its cell."""
    corner, heights = terrain.corner, terrain.heights
    column, row = (x - corner[0]) / CELL, (z - corner[1]) / CELL
    west = min(heights.shape[1] - 2, max(0, int(column)))
    south = min(heights.shape[0] - 2, max(0, int(row)))
    east = min(1.0, max(0.0, column - west))
    north = min(1.0, max(0.0, row - south))
    lower = heights[south, west] * (1.0 - east) + heights[south, west + 1] * east
    upper = heights[south + 1, west] * (1.0 - east) + heights[south + 1, west + 1] * east
    return float(lower * (1.0 - north) + upper * north)


def town_center(
    dice: RandomStream, terrain: Terrain, radius: float, others: list[Place], choices: int
) -> Place:
    """Return the middle of a town with a radius in m and its main street's yaw: the best of random places."""
    half = -terrain.corner[0]
    reach = max(0.3 * half, half - radius - EDGE_MARGIN)
    best, best_score = (0.0, 0.0, 0.0), -np.inf
    for _ in range(choices):
        x, z = dice.uniform(-reach, reach), dice.uniform(-reach, reach)
        yaw = dice.uniform(-180.0, 180.0)
        score = _town_score(terrain, x, z, sine(yaw), cosine(yaw), radius)
        for other_x, other_z, _ in others:
            apart = (x - other_x) * (x - other_x) + (z - other_z) * (z - other_z)
            score -= 0.0 if apart > 9.0 * radius * radius else 1.0 - apart / (9.0 * radius * radius)
        if score > best_score:
            best, best_score = (x, z, yaw), score
    return best


@kernel
def _town_score(
    terrain: Terrain, x: float, z: float, sine_of_yaw: float, cosine_of_yaw: float, radius: float
) -> float:
    """Return the score of a place for a town, up to 1: the share of it that can be built on."""
    good, count = 0.0, 0.0
    half = -terrain.corner[0] - EDGE_MARGIN
    for row in range(-4, 5):
        for column in range(-4, 5):
            along, across = row * radius / 4.0, column * radius / 8.0
            at_x = x + along * sine_of_yaw + across * cosine_of_yaw
            at_z = z + along * cosine_of_yaw - across * sine_of_yaw
            count += 1.0
            if max(abs(at_x), abs(at_z)) > half:
                continue
            height = height_at(terrain, at_x, at_z)
            east = height_at(terrain, at_x + 6.0, at_z) - height_at(terrain, at_x - 6.0, at_z)
            north = height_at(terrain, at_x, at_z + 6.0) - height_at(terrain, at_x, at_z - 6.0)
            steepness = (abs(east) + abs(north)) / 12.0
            if height > terrain.water_level + SHORE_MARGIN:
                good += max(0.0, 1.0 - 4.0 * steepness)
    return good / count
