"""Where agents and supplies may be: places that a body fits in and can walk to."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, TAN_SLOPE_LIMIT
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.kernel import array_kernel, kernel
from wildscav_engine.maps.house import FLOOR_LIFT, STOREY_HEIGHT, HousePlan
from wildscav_engine.maps.sites import Site
from wildscav_engine.rng import Dice, Stream, uniform_in

STREAM = int(Stream.LOCATIONS)
SPACING = 4.0  # m, of the jittered grid of outdoor places
STEEPEST_PLACE = 0.7002075382097097  # m up per m: 35°
INDOOR_SPACING = 2.2  # m between indoor places: one for about 5 m² of floor
TRIES = 4  # to find an indoor place that is clear of walls and stairs
CLEARANCE = 0.05  # m kept free around a body, and above the ground
NODE = 1.0  # m between the nodes of the ground that are joined to find what can be reached


@kernel
def is_clear(world: World, x: float, y: float, z: float) -> bool:
    """Return whether a body that stands at a place in m touches no solid (the terrain is not looked at)."""
    rows, columns = world.water.shape
    radius, low, high = BODY_RADIUS + CLEARANCE, y + CLEARANCE, y + BODY_HEIGHT + CLEARANCE
    for row in range(
        cell_of(world.corner[1], z - radius, rows), cell_of(world.corner[1], z + radius, rows) + 1
    ):
        for column in range(
            cell_of(world.corner[0], x - radius, columns), cell_of(world.corner[0], x + radius, columns) + 1
        ):
            cell = row * columns + column
            for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
                if _touches(world, world.cell_solids[item], x, z, radius, low, high):
                    return False
    return True


@kernel
def _touches(world: World, solid: int, x: float, z: float, radius: float, low: float, high: float) -> bool:
    """Return whether an upright cylinder reaches behind all faces of a solid and into its box."""
    least, most = world.solid_low[solid], world.solid_high[solid]
    if low >= most[1] or high <= least[1]:
        return False
    if x - radius >= most[0] or x + radius <= least[0] or z - radius >= most[2] or z + radius <= least[2]:
        return False
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n_x, n_y, n_z = world.faces[face, 0], world.faces[face, 1], world.faces[face, 2]
        y = low if n_y > 0.0 else high
        reach = radius * np.sqrt(n_x * n_x + n_z * n_z)
        if n_x * x + n_y * y + n_z * z - reach >= world.faces[face, 3]:
            return False
    return True


@array_kernel
def reachable_ground(world: World) -> NDArray[np.bool_]:
    """Return the largest part of the ground that can be walked over, as nodes 1 m apart.

    Returns:
        (R, C), node (row, column) at the corner of the map plus (column, row) metres. Lakes are waded.
    """
    rows, columns = 2 * world.water.shape[0] + 1, 2 * world.water.shape[1] + 1
    height = np.empty((rows, columns))
    part = np.full((rows, columns), -1, np.int32)  # -1: nobody fits there; 0: not looked at yet
    for row in range(1, rows - 1):
        for column in range(1, columns - 1):
            x, z = world.corner[0] + column * NODE, world.corner[1] + row * NODE
            ground = ground_at(world, x, z)
            height[row, column] = ground.height
            steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
            if steepness < TAN_SLOPE_LIMIT and is_clear(world, x, ground.height, z):
                part[row, column] = 0
    queue = np.empty(rows * columns, np.int32)
    largest, largest_size, parts = 0, 0, 0
    for start in range(rows * columns):
        if part[start // columns, start % columns] == 0:
            parts += 1
            size = _fill(height, part, queue, start, parts)
            if size > largest_size:
                largest, largest_size = parts, size
    return part == largest if largest else np.zeros((rows, columns), np.bool_)


@kernel
def _fill(
    height: NDArray[np.float64], part: NDArray[np.int32], queue: NDArray[np.int32], start: int, number: int
) -> int:
    """Give a number to all nodes that can be walked to from one, and return how many they are."""
    rows, columns = part.shape
    queue[0] = start
    part[start // columns, start % columns] = number
    done, found = 0, 1
    while done < found:
        row, column = queue[done] // columns, queue[done] % columns
        done += 1
        for side in range(4):
            next_row = row + (side == 0) - (side == 1)
            next_column = column + (side == 2) - (side == 3)
            if not (0 <= next_row < rows and 0 <= next_column < columns):
                continue
            if part[next_row, next_column] != 0:
                continue
            if abs(height[next_row, next_column] - height[row, column]) < TAN_SLOPE_LIMIT * NODE:
                part[next_row, next_column] = number
                queue[found] = next_row * columns + next_column
                found += 1
    return found


@array_kernel
def outdoor_places(world: World, reachable: NDArray[np.bool_], seed: np.uint64) -> NDArray[np.float64]:
    """Return (N, 3) m, standing places on dry, fairly level, open ground that can be reached."""
    rows = int(world.water.shape[0] * 2.0 / SPACING)
    columns = int(world.water.shape[1] * 2.0 / SPACING)
    places = np.empty((rows * columns, 3))
    found = 0
    for row in range(rows):
        for column in range(columns):
            east = (column + uniform_in(0.15, 0.85, seed, STREAM, 1, row, 2 * column)) * SPACING
            north = (row + uniform_in(0.15, 0.85, seed, STREAM, 1, row, 2 * column + 1)) * SPACING
            if not reachable[int(north / NODE + 0.5), int(east / NODE + 0.5)]:
                continue
            x, z = world.corner[0] + east, world.corner[1] + north
            ground = ground_at(world, x, z)
            steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
            cell = world.water[int(north * 0.5), int(east * 0.5)]
            if steepness < STEEPEST_PLACE and cell < ground.height and is_clear(world, x, ground.height, z):
                places[found] = (x, ground.height, z)
                found += 1
    return places[:found]


def indoor_places(
    world: World, seed: int, number: int, plan: HousePlan, site: Site
) -> list[tuple[float, float, float]]:
    """Return standing places in m on all floors of a house."""
    dice = Dice(seed, Stream.LOCATIONS, agent=1000 + number)
    places = []
    for level, storey in enumerate(plan.storeys):
        floor = site.ground + FLOOR_LIFT + level * STOREY_HEIGHT
        for room in storey.rooms:
            left, back, right, front = room.area
            columns = max(1, round((right - left) / INDOOR_SPACING))
            rows = max(1, round((front - back) / INDOOR_SPACING))
            for row in range(rows):
                for column in range(columns):
                    for _ in range(TRIES):
                        across = left + (right - left) * (column + dice.uniform(0.1, 0.9)) / columns
                        along = back + (front - back) * (row + dice.uniform(0.1, 0.9)) / rows
                        x, z = site.pose.outside(across, along)
                        if not _is_over(storey.hole, across, along) and is_clear(world, x, floor, z):
                            places.append((x, floor, z))
                            break
    return places


def _is_over(hole: Rectangle | None, across: float, along: float) -> bool:
    """Return whether a place is over the hole in a floor."""
    return bool(hole and hole.left <= across <= hole.right and hole.back <= along <= hole.front)
