"""The top view of a map: a grid of rays cast straight down into the world.

Houses may be cut open at a storey, as in a floor plan: there, rays start at the height of the cut, so that
they show the rooms. Where a ray starts inside a wall, the wall is cut.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT, raycast
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.geometry.world import CELL, Kind, World, cell_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.settlements.houses import House

CUT_HEIGHT = 1.35  # m above the floor: above window sills, below the tops of doors
EAVES = 0.9  # m that a roof may reach beyond the walls
LIFT = 0.01  # m that a ray to the sun starts off the surface
# Light comes from the upper left, so that hills do not look like hollows.
SUN_YAW, SUN_HEIGHT = 315.0, 40.0  # degrees
SUN_RADIUS = 1.0  # degrees; neighbouring samples aim at four corners of the sun, for soft shadows
EXAGGERATION = 1.25  # factor of the terrain's slopes in its shading

NOTHING, TERRAIN, WATER = int(Kind.NOTHING), int(Kind.TERRAIN), int(Kind.WATER)
FAR = 1e5  # m


class Window(NamedTuple):
    """The part of a map that is shown: rows of samples from north to south, each from west to east."""

    west: float  # m, x of its left edge
    north: float  # m, z of its upper edge
    step: float  # m between samples
    rows: int
    columns: int


class TopView(NamedTuple):
    """What each sample of a window shows; all arrays have the shape (rows, columns)."""

    kind: NDArray[np.int8]  # a Kind
    solid: NDArray[np.int32]  # the solid seen, -1 for none
    height: NDArray[np.float32]  # m, of the visible surface
    light: NDArray[np.float32]  # how directly it faces the sun, relative to level ground
    sunny: NDArray[np.bool_]  # whether the sun reaches it
    opened: NDArray[np.bool_]  # whether it is visible through the cut of a house
    cut: NDArray[np.bool_]  # whether the cut goes through it
    ground: NDArray[np.float32]  # m, height of the terrain, smoothly interpolated
    slope: NDArray[np.float32]  # m up per m, of that
    # m of water over it; negative above the water's surface; -inf far away from water
    depth: NDArray[np.float32]


def allocate_top_view(rows: int, columns: int) -> TopView:
    """Return uninitialized arrays for a top view."""
    types = (np.int8, np.int32, *(np.float32,) * 2, *(np.bool_,) * 3, *(np.float32,) * 3)
    return TopView(*(np.empty((rows, columns), kind) for kind in types))


def cuts_at(game_map: GameMap, storey: int | None) -> NDArray[np.float64]:
    """Return the rectangles in which rays start lower, so that houses are cut open at a storey, from 1 on.

    Each is a row, (N, 9): x and z in m, sine and cosine of the yaw, then left, back, right and front edges in
    those axes, and the height of the cut, all in m.
    """
    if storey is None:
        return np.zeros((0, 9))
    rows = []
    for house in game_map.houses:
        if house.storeys >= storey:
            height = house.ground + (storey - 1) * house.storey_height + CUT_HEIGHT
            for left, back, right, front in outlines(house):
                edges = (left - EAVES, back - EAVES, right + EAVES, front + EAVES)
                rows.append((*house.pose, *edges, height))
    return np.array(rows, np.float64).reshape(-1, 9)


def outlines(house: House) -> list[Rectangle]:
    """Return the outlines of a house's parts in its own axes."""
    return [*house.wings] or [house.outline]


@kernel
def cast_top_view(
    world: World,
    water: NDArray[np.float64],
    sky: float,
    cuts: NDArray[np.float64],
    window: Window,
    seen: TopView,
) -> None:
    """Cast the rays of a window from a height above everything, or from the ``cuts_at`` a storey.

    The water, (R, C) m, is that in or near each cell; see ``water_nearby``.
    """
    suns = _direction_to_sun(0), _direction_to_sun(1), _direction_to_sun(2), _direction_to_sun(3)
    for row in range(window.rows):
        z = window.north - (row + 0.5) * window.step
        for column in range(window.columns):
            x = window.west + (column + 0.5) * window.step
            start = min(sky, _cut_height(cuts, x, z))
            sun = suns[2 * (row % 2) + column % 2]
            _cast_sample(world, water, x, z, sky, start, sun, row, column, seen)


@kernel
def _cut_height(cuts: NDArray[np.float64], x: float, z: float) -> float:
    """Return the height of the cut at (x, z), inf without one."""
    for cut in range(cuts.shape[0]):
        east, north = x - cuts[cut, 0], z - cuts[cut, 1]
        across = east * cuts[cut, 3] - north * cuts[cut, 2]
        along = east * cuts[cut, 2] + north * cuts[cut, 3]
        if cuts[cut, 4] <= across <= cuts[cut, 6] and cuts[cut, 5] <= along <= cuts[cut, 7]:
            return float(cuts[cut, 8])
    return np.inf


@kernel
def _cast_sample(
    world: World,
    water: NDArray[np.float64],
    x: float,
    z: float,
    sky: float,
    start: float,
    sun: tuple[float, float, float],
    row: int,
    column: int,
    seen: TopView,
) -> None:
    """Write one sample: the surface below a height at (x, z), and the sunlight on it."""
    ground, slope_x, slope_z = smooth_ground(world, x, z)
    surface = water[cell_of(world.corner[1], z, water.shape[0]), cell_of(world.corner[0], x, water.shape[1])]
    seen.ground[row, column] = ground
    seen.slope[row, column] = np.sqrt(slope_x * slope_x + slope_z * slope_z)
    seen.depth[row, column] = surface - ground
    hit = raycast(world, x, start, z, 0.0, -1.0, 0.0, FAR)
    sun_x, sun_y, sun_z = sun
    height = start - hit.distance
    kind, normal_x, normal_y, normal_z = TERRAIN, -EXAGGERATION * slope_x, 1.0, -EXAGGERATION * slope_z
    if hit.solid == NOTHING_HIT:
        kind, height = NOTHING, 0.0
    elif hit.solid != TERRAIN_HIT:
        kind = int(np.int64(world.solid_kind[hit.solid]))
        face = world.faces[hit.face]
        normal_x, normal_y, normal_z = face[0], face[1], face[2]
    elif ground < surface:
        kind, height, normal_x, normal_z = WATER, surface, 0.0, 0.0
    is_open = start < sky
    is_cut = is_open and hit.solid >= 0 and hit.distance == 0.0
    if is_cut:
        normal_x, normal_y, normal_z = 0.0, 1.0, 0.0
    length = np.sqrt(normal_x * normal_x + normal_y * normal_y + normal_z * normal_z)
    light = (normal_x * sun_x + normal_y * sun_y + normal_z * sun_z) / (length * sun_y)
    seen.kind[row, column] = kind
    seen.solid[row, column] = max(hit.solid, -1)
    seen.height[row, column] = height
    seen.light[row, column] = light
    seen.opened[row, column] = is_open
    seen.cut[row, column] = is_cut
    # Nothing is above ``sky``; and the sun shines into an opened house through the cut.
    far = ((start if hit.solid >= 0 else sky) - height) / sun_y
    seen.sunny[row, column] = kind == NOTHING or (
        light > 0.0 and raycast(world, x, height + LIFT, z, sun_x, sun_y, sun_z, far).solid == NOTHING_HIT
    )


@kernel
def _direction_to_sun(corner: int) -> tuple[float, float, float]:
    """Return the unit vector to a corner of the sun, 0-3."""
    yaw = SUN_YAW + SUN_RADIUS * (2.0 * (corner % 2) - 1.0)
    height = SUN_HEIGHT + SUN_RADIUS * (2.0 * (corner // 2) - 1.0)
    level = cosine(height)
    return level * sine(yaw), sine(height), level * cosine(yaw)


@kernel
def smooth_ground(world: World, x: float, z: float) -> tuple[float, float, float]:
    """Return the height in m and the slopes of a smooth surface through the terrain's corners.

    Bicubic: Catmull & Rom, "A class of local interpolating splines", 1974.
    """
    rows, columns = world.water.shape
    row, column = cell_of(world.corner[1], z, rows), cell_of(world.corner[0], x, columns)
    east = min(1.0, max(0.0, (x - world.corner[0]) / CELL - column))
    north = min(1.0, max(0.0, (z - world.corner[1]) / CELL - row))
    height, slope_east, slope_north = 0.0, 0.0, 0.0
    for i in range(4):
        weight, change = _spline(i, north)
        here = min(rows, max(0, row + i - 1))
        along, along_change = 0.0, 0.0
        for j in range(4):
            part, part_change = _spline(j, east)
            corner = world.heights[here, min(columns, max(0, column + j - 1))]
            along += part * corner
            along_change += part_change * corner
        height += weight * along
        slope_east += weight * along_change
        slope_north += change * along
    return height, slope_east / CELL, slope_north / CELL


@kernel
def _spline(index: int, t: float) -> tuple[float, float]:
    """Return the weight of one of four values around t in [0, 1] and its derivative."""
    if index == 0:
        return ((2.0 - t) * t - 1.0) * t * 0.5, ((4.0 - 3.0 * t) * t - 1.0) * 0.5
    if index == 1:
        return ((3.0 * t - 5.0) * t * t + 2.0) * 0.5, (9.0 * t - 10.0) * t * 0.5
    if index == 2:
        return ((4.0 - 3.0 * t) * t + 1.0) * t * 0.5, ((8.0 - 9.0 * t) * t + 1.0) * 0.5
    return (t - 1.0) * t * t * 0.5, (3.0 * t - 2.0) * t * 0.5
