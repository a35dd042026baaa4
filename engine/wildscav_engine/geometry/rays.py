"""Casting single rays: what a ray meets first in the static world.

A ray traverses the grid cell by cell (Amanatides & Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
Eurographics 1987) and skips blocks and cells that it passes above.

Bullets, lines of sight, heights under a roof and pictures of maps use this, and steep rays of LIDAR. Casting
many rays at once gives the same answers: ``rendering.trace`` (cameras) and ``rendering.panorama`` (LIDAR).
"""

import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import BLOCK, CELL, World

NOTHING_HIT = -2
TERRAIN_HIT = -1


class Hit(NamedTuple):
    """What a ray met."""

    distance: float  # m along the ray, inf if nothing was hit
    solid: int  # index of the solid, TERRAIN_HIT or NOTHING_HIT
    face: int  # index into World.faces; for terrain 0 for the south-eastern triangle, 1 for the other


class Ray(NamedTuple):
    """A ray in the world, in m and in units of cells from the map's corner."""

    x: float  # m, where it starts; so y and z
    y: float
    z: float
    dx: float  # unit vector of its direction; so dy and dz
    dy: float
    dz: float
    east: float  # cells from the corner, where it starts
    north: float
    d_east: float  # cells per metre along the ray
    d_north: float
    per_east: float  # metres along the ray per cell, inf if it never crosses one
    per_north: float


@kernel
def make_ray(world: World, x: float, y: float, z: float, dx: float, dy: float, dz: float) -> Ray:
    """Return the ray from a start in m along a unit vector."""
    east, north = (x - world.corner[0]) / CELL, (z - world.corner[1]) / CELL
    per_east = CELL / dx if dx != 0.0 else np.inf
    per_north = CELL / dz if dz != 0.0 else np.inf
    return Ray(x, y, z, dx, dy, dz, east, north, dx / CELL, dz / CELL, per_east, per_north)


class Step(NamedTuple):
    """The position of a ray in its traversal of the grid."""

    at: float  # m along the ray
    row: int
    column: int


@kernel
def raycast(
    world: World, x: float, y: float, z: float, dx: float, dy: float, dz: float, max_distance: float
) -> Hit:
    """Return the nearest hit of a ray.

    Args:
        x: m, where the ray starts; so y and z. A start outside the map hits nothing.
        dx: Unit vector of the ray's direction; so dy and dz.
        max_distance: m, hits beyond it are ignored.

    Returns:
        The hit; at distance 0 if the ray starts inside a solid or below the ground.
    """
    ray = make_ray(world, x, y, z, dx, dy, dz)
    rows, columns = world.water.shape
    step = Step(0.0, int(np.floor(ray.north)), int(np.floor(ray.east)))
    best = Hit(np.inf, NOTHING_HIT, 0)
    while step.at < max_distance and 0 <= step.row < rows and 0 <= step.column < columns:
        block_row, block_column = step.row // BLOCK, step.column // BLOCK
        over = leave_square(ray, step, block_row * BLOCK, block_column * BLOCK, BLOCK, max_distance)
        if min(y + dy * step.at, y + dy * over.at) > world.block_top[block_row, block_column]:
            step = over
            continue
        step, best = _cross_block(world, ray, step, block_row, block_column, max_distance, best)
        # The hit may lie beyond the cells visited so far; then later cells may still hold a nearer one.
        if best.distance <= step.at:
            break
    return best if best.distance <= max_distance else Hit(np.inf, NOTHING_HIT, 0)


@kernel
def leave_square(ray: Ray, step: Step, row: int, column: int, side: int, max_distance: float) -> Step:
    """Return the first step of a ray beyond the square of cells that it is in.

    Args:
        row: Least row of the square.
        column: Least column.
        max_distance: m; the step goes no farther, and may then still be in the square.
    """
    edge_column = column + side if ray.d_east > 0.0 else column
    edge_row = row + side if ray.d_north > 0.0 else row
    out_east = (edge_column - ray.east) * ray.per_east if ray.d_east != 0.0 else np.inf
    out_north = (edge_row - ray.north) * ray.per_north if ray.d_north != 0.0 else np.inf
    at = min(out_east, out_north, max_distance)
    # The coordinate that crosses the edge is exact; the other is clamped to the square against rounding.
    if out_east <= out_north:
        beyond = edge_column if ray.d_east > 0.0 else edge_column - 1
        along = step.row if side == 1 else int(np.floor(ray.north + ray.d_north * at))
        return Step(at, max(row, min(row + side - 1, along)), beyond)
    beyond = edge_row if ray.d_north > 0.0 else edge_row - 1
    along = step.column if side == 1 else int(np.floor(ray.east + ray.d_east * at))
    return Step(at, beyond, max(column, min(column + side - 1, along)))


@kernel
def _cross_block(
    world: World, ray: Ray, step: Step, block_row: int, block_column: int, max_distance: float, best: Hit
) -> tuple[Step, Hit]:
    """Move a ray through the cells of a block until it leaves the block, hits something or ends."""
    rows, columns = world.water.shape
    while (
        step.at < max_distance
        and step.row // BLOCK == block_row
        and step.column // BLOCK == block_column
        and 0 <= step.row < rows
        and 0 <= step.column < columns
    ):
        over = leave_square(ray, step, step.row, step.column, 1, max_distance)
        if min(ray.y + ray.dy * step.at, ray.y + ray.dy * over.at) <= world.cell_top[step.row, step.column]:
            best = _nearer_in_cell(world, ray, step, over.at, best)
        step = over
        if best.distance <= step.at:
            break
    return step, best


@kernel
def _nearer_in_cell(world: World, ray: Ray, step: Step, leave: float, best: Hit) -> Hit:
    """Return the nearest of the best hit so far and the hits in a cell, which the ray leaves at ``leave``."""
    distance, triangle = intersect_terrain(world, ray, step, leave)
    if distance < best.distance:
        best = Hit(distance, TERRAIN_HIT, triangle)
    cell = step.row * world.water.shape[1] + step.column
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        distance, face = intersect_solid(world, solid, ray, best.distance)
        if distance < best.distance:
            best = Hit(distance, solid, face)
    return best


@kernel
def intersect_terrain(world: World, ray: Ray, step: Step, leave: float) -> tuple[float, int]:
    """Return where a ray hits one of a cell's two triangles, and which one; inf if it hits neither."""
    h00, h01 = world.heights[step.row, step.column], world.heights[step.row, step.column + 1]
    h10, h11 = world.heights[step.row + 1, step.column], world.heights[step.row + 1, step.column + 1]
    if min(ray.y + ray.dy * step.at, ray.y + ray.dy * leave) > max(h00, h01, h10, h11):
        return np.inf, 0
    east, north = ray.east - step.column, ray.north - step.row
    # The diagonal is where east and north are equal.
    gap, d_gap = east - north, ray.d_east - ray.d_north
    middle = leave
    if d_gap != 0.0 and step.at < -gap / d_gap < leave:
        middle = -gap / d_gap
    start, end = step.at, middle
    for _ in range(2):
        south_east = gap + d_gap * (start + end) * 0.5 >= 0.0
        slope_east = h01 - h00 if south_east else h11 - h10
        slope_north = h11 - h01 if south_east else h10 - h00
        above = ray.y - (h00 + slope_east * east + slope_north * north)
        d_above = ray.dy - (slope_east * ray.d_east + slope_north * ray.d_north)
        above_start, above_end = above + d_above * start, above + d_above * end
        if above_start <= 0.0:
            return start, 0 if south_east else 1
        if above_end <= 0.0:
            along = start + (end - start) * above_start / (above_start - above_end)
            return min(end, along), 0 if south_east else 1
        if middle == leave:
            break
        start, end = middle, leave
    return np.inf, 0


@kernel
def intersect_solid(world: World, solid: int, ray: Ray, nearest: float) -> tuple[float, int]:
    """Return where a ray enters a solid and through which face; inf if it does not before ``nearest``."""
    return intersect_faces(world.faces, world.solid_start[solid], world.solid_start[solid + 1], ray, nearest)


@kernel
def intersect_faces(
    faces: NDArray[np.float64], start: int, end: int, ray: Ray, nearest: float
) -> tuple[float, int]:
    """Return where a ray enters the solid with rows ``start`` to ``end`` of faces, and through which face.

    The distance is inf if the ray does not enter before ``nearest``. The ray is clipped by each face: Cyrus &
    Beck, "Generalized Two- and Three-Dimensional Clipping", 1978.
    """
    enter, leave, entered_by = 0.0, nearest, 0
    for face in range(start, end):
        n_x, n_y, n_z = faces[face, 0], faces[face, 1], faces[face, 2]
        outside = n_x * ray.x + n_y * ray.y + n_z * ray.z - faces[face, 3]
        speed = n_x * ray.dx + n_y * ray.dy + n_z * ray.dz
        if speed < 0.0:
            crossing = -outside / speed
            if crossing > enter:
                enter, entered_by = crossing, face
        elif outside > 0.0:
            return np.inf, 0
        elif speed > 0.0:
            leave = min(leave, -outside / speed)
        if enter > leave:
            return np.inf, 0
    return enter, entered_by


@kernel
def sight_is_clear(world: World, x: float, y: float, z: float, to_x: float, to_y: float, to_z: float) -> bool:
    """Return whether the static world leaves the line of sight between two points free."""
    dx, dy, dz = to_x - x, to_y - y, to_z - z
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    if distance == 0.0:
        return True
    hit = raycast(world, x, y, z, dx / distance, dy / distance, dz / distance, distance)
    return hit.solid == NOTHING_HIT


def __getattr__(name: str) -> Any:
    """Return a name by its old spelling, for one release."""
    if name != "cast_ray":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn("cast_ray is called raycast now", DeprecationWarning, stacklevel=2)
    return raycast
