"""The one ray kernel: what a ray meets first in the static world.

A ray walks the grid cell by cell (Amanatides & Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
Eurographics 1987) and skips blocks and cells that it passes above.
"""

from typing import NamedTuple

import numpy as np

from wildscav_engine.geometry.world import BLOCK, CELL, Kind, World
from wildscav_engine.kernel import kernel

NOTHING_HIT = -2
TERRAIN_HIT = -1
NOTHING, TERRAIN = int(Kind.NOTHING), int(Kind.TERRAIN)


class Hit(NamedTuple):
    """What a ray met."""

    distance: float  # m along the ray, inf if nothing was hit
    solid: int  # index of the solid, TERRAIN_HIT or NOTHING_HIT
    face: int  # index into World.faces; for terrain 0 for the south-eastern triangle, 1 for the other


@kernel
def cast_ray(world: World, x: float, y: float, z: float, dx: float, dy: float, dz: float, far: float) -> Hit:
    """Return the nearest hit of a ray.

    Args:
        world: The static world.
        x: m, where the ray starts; so y and z. A start outside the map hits nothing.
        y: m.
        z: m.
        dx: Unit vector of the ray's direction; so dy and dz.
        dy: See dx.
        dz: See dx.
        far: m, hits beyond are ignored.

    Returns:
        The hit; at distance 0 if the ray starts inside a solid or below the ground.
    """
    rows, columns = world.water.shape
    # In units of cells from the corner, so that cells are found by rounding down.
    east, north = (x - world.corner[0]) / CELL, (z - world.corner[1]) / CELL
    d_east, d_north = dx / CELL, dz / CELL
    inverse_east = 1.0 / d_east if d_east != 0.0 else np.inf
    inverse_north = 1.0 / d_north if d_north != 0.0 else np.inf
    column, row = int(np.floor(east)), int(np.floor(north))
    best = Hit(np.inf, NOTHING_HIT, 0)
    at = 0.0
    while at < far and 0 <= row < rows and 0 <= column < columns:
        block_row, block_column = row // BLOCK, column // BLOCK
        edge_column = (block_column + 1) * BLOCK if d_east > 0.0 else block_column * BLOCK
        edge_row = (block_row + 1) * BLOCK if d_north > 0.0 else block_row * BLOCK
        out_east = (edge_column - east) * inverse_east if d_east != 0.0 else np.inf
        out_north = (edge_row - north) * inverse_north if d_north != 0.0 else np.inf
        leave = min(out_east, out_north, far)
        if min(y + dy * at, y + dy * leave) > world.block_top[block_row, block_column]:
            at = leave
            if out_east <= out_north:
                column = edge_column if d_east > 0.0 else edge_column - 1
                row = _row_within(int(np.floor(north + d_north * at)), block_row)
            else:
                row = edge_row if d_north > 0.0 else edge_row - 1
                column = _row_within(int(np.floor(east + d_east * at)), block_column)
            continue
        while (
            at < far
            and 0 <= row < rows
            and 0 <= column < columns
            and row // BLOCK == block_row
            and column // BLOCK == block_column
        ):
            next_east, next_north = np.inf, np.inf
            if d_east != 0.0:
                next_east = (column + (1 if d_east > 0.0 else 0) - east) * inverse_east
            if d_north != 0.0:
                next_north = (row + (1 if d_north > 0.0 else 0) - north) * inverse_north
            leave = min(next_east, next_north, far)
            if min(y + dy * at, y + dy * leave) <= world.cell_top[row, column]:
                best = _nearer_in_cell(world, row, column, x, y, z, dx, dy, dz, at, leave, best)
                # A solid may be met beyond this cell: then nearer things may still lie before it.
                if best.distance <= leave:
                    return best if best.distance <= far else Hit(np.inf, NOTHING_HIT, 0)
            at = leave
            if next_east <= next_north:
                column += 1 if d_east > 0.0 else -1
            else:
                row += 1 if d_north > 0.0 else -1
    return best if best.distance <= far else Hit(np.inf, NOTHING_HIT, 0)


@kernel
def _row_within(row: int, block: int) -> int:
    """Keep a row (or column) that was found by rounding inside its block."""
    return max(block * BLOCK, min(block * BLOCK + BLOCK - 1, row))


@kernel
def _nearer_in_cell(
    world: World,
    row: int,
    column: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    at: float,
    leave: float,
    best: Hit,
) -> Hit:
    """Return the nearest of the best hit so far and the hits in one cell, which holds [at, leave]."""
    distance, triangle = _meet_terrain(world, row, column, x, y, z, dx, dy, dz, at, leave)
    if distance < best.distance:
        best = Hit(distance, TERRAIN_HIT, triangle)
    cell = row * world.water.shape[1] + column
    for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
        solid = world.cell_solids[item]
        distance, face = meet_solid(world, solid, x, y, z, dx, dy, dz, best.distance)
        if distance < best.distance:
            best = Hit(distance, solid, face)
    return best


@kernel
def _meet_terrain(
    world: World,
    row: int,
    column: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    at: float,
    leave: float,
) -> tuple[float, int]:
    """Return where a ray goes below the two triangles of a cell, and which; inf if it does not."""
    h00, h01 = world.heights[row, column], world.heights[row, column + 1]
    h10, h11 = world.heights[row + 1, column], world.heights[row + 1, column + 1]
    if min(y + dy * at, y + dy * leave) > max(h00, h01, h10, h11):
        return np.inf, 0
    east, north = (x - world.corner[0]) / CELL - column, (z - world.corner[1]) / CELL - row
    d_east, d_north = dx / CELL, dz / CELL
    # The diagonal is where east and north are equal.
    gap, d_gap = east - north, d_east - d_north
    middle = leave
    if d_gap != 0.0:
        crossing = -gap / d_gap
        if at < crossing < leave:
            middle = crossing
    start = at
    for _ in range(2):
        end = middle
        south_east = gap + d_gap * (start + end) * 0.5 >= 0.0
        slope_east = h01 - h00 if south_east else h11 - h10
        slope_north = h11 - h01 if south_east else h10 - h00
        above = y - (h00 + slope_east * east + slope_north * north)
        d_above = dy - (slope_east * d_east + slope_north * d_north)
        above_start, above_end = above + d_above * start, above + d_above * end
        if above_start <= 0.0:
            return start, 0 if south_east else 1
        if above_end <= 0.0:
            along = start + (end - start) * above_start / (above_start - above_end)
            return min(end, along), 0 if south_east else 1
        if middle == leave:
            break
        start, middle = middle, leave
    return np.inf, 0


@kernel
def meet_solid(
    world: World,
    solid: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    nearest: float,
) -> tuple[float, int]:
    """Return where a ray enters a solid and by which face; inf if it does not before ``nearest``.

    Clips the ray by each face: Cyrus & Beck, "Generalized Two- and Three-Dimensional Clipping", 1978.
    """
    enter, leave, entered_by = 0.0, nearest, 0
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n_x, n_y, n_z = world.faces[face, 0], world.faces[face, 1], world.faces[face, 2]
        outside = n_x * x + n_y * y + n_z * z - world.faces[face, 3]
        speed = n_x * dx + n_y * dy + n_z * dz
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
    """Return whether nothing of the static world stands between two points."""
    dx, dy, dz = to_x - x, to_y - y, to_z - z
    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
    if distance == 0.0:
        return True
    hit = cast_ray(world, x, y, z, dx / distance, dy / distance, dz / distance, distance)
    return hit.solid == NOTHING_HIT


@kernel
def kind_of(world: World, hit: Hit) -> int:
    """Return the Kind of what a ray met."""
    if hit.solid == NOTHING_HIT:
        return NOTHING
    if hit.solid == TERRAIN_HIT:
        return TERRAIN
    return int(np.int64(world.solid_kind[hit.solid]))
