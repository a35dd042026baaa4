"""Collisions of a moving body with solids and other bodies, and the displacement that is left afterwards.

The solids near a body are found once and used by all sweeps of one move: near houses a cell lists dozens of
solids, but a body can touch only a few of them in one move. These few are kept as bit masks: one for each of
the up to four cells that the body reaches into, with one bit for each solid that the cell lists.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import (
    FREE,
    SKIN,
    Contact,
    box_of_sweep,
    is_apart,
    is_body_near,
    sweep_bodies,
    sweep_solid,
    sweep_world,
)
from wildscav_engine.geometry.world import CELL, World, cell_of
from wildscav_engine.specs.actions import MAX_WALK_SPEED
from wildscav_engine.specs.body import (
    BODY_HEIGHT,
    BODY_RADIUS,
    COS_SLOPE_LIMIT,
    EDGE_MARGIN,
    FALL_SPEED_LIMIT,
)
from wildscav_engine.specs.rules import FRAME

BITS = 62  # solids of a cell that can have a bit; with more, every solid is swept
BYTE = 255
SLIDES = 4  # how many surfaces one move can slide along
FARTHEST = MAX_WALK_SPEED * FRAME  # m, the greatest horizontal displacement in a frame, by any means
TOUCHING = 3.0 * SKIN  # m; a body this close above a surface stands on it
# A slide removes slightly more than the displacement into the surface, so that rounding cannot make bodies
# stick.
SEPARATION = 1.0 + 1e-6
BELOW = FALL_SPEED_LIMIT * FRAME + FARTHEST  # m below the soles that a move can reach
ABOVE = BODY_HEIGHT + 1.6  # m above them: up a step, up a slope and up onto the ground


class NearbySolids(NamedTuple):
    """The solids that a body can touch, in up to 2 × 2 cells: bit i stands for the i-th solid of a cell."""

    row: int  # of the south-western cell
    column: int
    south_west: int
    south_east: int
    north_west: int
    north_east: int
    is_crowded: bool  # whether a cell has more solids than bits


@kernel
def find_nearby_solids(
    world: World, x: float, z: float, reach: float, low: float, high: float
) -> NearbySolids:
    """Find all solids whose boxes are near a body.

    Args:
        x: m, the middle of the body.
        reach: m to all sides, less than half a cell.
        low: m, the lowest height that counts.
        high: m, the greatest.
    """
    rows, columns = world.water.shape
    west, east = cell_of(world.corner[0], x - reach, columns), cell_of(world.corner[0], x + reach, columns)
    south, north = cell_of(world.corner[1], z - reach, rows), cell_of(world.corner[1], z + reach, rows)
    south_west, south_east, north_west, north_east = 0, 0, 0, 0
    is_crowded = False
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            if world.cell_top[row, column] < low:
                continue
            cell = row * columns + column
            start = world.cell_start[cell]
            bits = 0
            for item in range(start, world.cell_start[cell + 1]):
                solid = world.cell_solids[item]
                if world.solid_low[solid, 1] > high:
                    break  # all solids after it begin higher still
                if (
                    world.solid_high[solid, 1] < low
                    or world.solid_low[solid, 0] > x + reach
                    or world.solid_high[solid, 0] < x - reach
                    or world.solid_low[solid, 2] > z + reach
                    or world.solid_high[solid, 2] < z - reach
                ):
                    continue
                # A solid that an earlier cell lists, too, has its bit there.
                if column > west and cell_of(world.corner[0], world.solid_low[solid, 0], columns) < column:
                    continue
                if row > south and cell_of(world.corner[1], world.solid_low[solid, 2], rows) < row:
                    continue
                is_crowded = is_crowded or item - start >= BITS
                bits |= 1 << min(item - start, BITS - 1)
            if row == south and column == west:
                south_west = bits
            elif row == south:
                south_east = bits
            elif column == west:
                north_west = bits
            else:
                north_east = bits
    return NearbySolids(south, west, south_west, south_east, north_west, north_east, is_crowded)


@kernel
def has_nearby_solids(nearby: NearbySolids) -> bool:
    """Return whether any solid is near."""
    return (nearby.south_west | nearby.south_east | nearby.north_west | nearby.north_east) != 0


@kernel
def sweep_nearby_solids(
    world: World, nearby: NearbySolids, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Contact:
    """Return how far a body can go before it touches one of the solids near it; see ``sweep_world``."""
    if nearby.is_crowded:
        return sweep_world(world, x, y, z, dx, dy, dz)
    columns = world.water.shape[1]
    first = FREE
    swept = box_of_sweep(x, y, z, dx, dy, dz)
    for part in range(4):
        bits = nearby.south_west
        if part == 1:
            bits = nearby.south_east
        elif part == 2:
            bits = nearby.north_west
        elif part == 3:
            bits = nearby.north_east
        if bits == 0:
            continue
        item = world.cell_start[(nearby.row + part // 2) * columns + nearby.column + part % 2]
        while bits != 0:
            if bits & BYTE == 0:
                bits >>= 8
                item += 8
                continue
            solid = world.cell_solids[item]
            if bits & 1 != 0 and not is_apart(world, solid, swept):
                contact = sweep_solid(world, solid, x, y, z, dx, dy, dz)
                if contact.fraction < first.fraction:
                    first = contact
            bits >>= 1
            item += 1
    return first


class Bodies(NamedTuple):
    """The bodies of a match, as obstacles to the one that moves."""

    position: NDArray[np.float64]  # (A, 3) m, soles
    others: NDArray[np.int32]  # (N,) indices of those that can be touched
    mover: int


class Point(NamedTuple):
    """A place or a displacement, in m."""

    x: float
    y: float
    z: float


class Moved(NamedTuple):
    """The state of a body after a move."""

    x: float
    y: float
    z: float
    rise: float  # m/s, the vertical speed
    on_ground: bool


class Surroundings(NamedTuple):
    """The solids and bodies that a body can touch in one move."""

    solids: NearbySolids
    has_solids: bool
    has_bodies: bool


@kernel
def find_surroundings(world: World, bodies: Bodies, here: Point, far: float) -> Surroundings:
    """Find what a body can touch in a move of up to ``far`` m sideways; ``far`` is at most 0.5."""
    reach = BODY_RADIUS + 2.0 * SKIN + far
    solids = find_nearby_solids(world, here.x, here.z, reach, here.y - BELOW, here.y + ABOVE)
    has_bodies = is_body_near(bodies.position, bodies.others, bodies.mover, here.x, here.y, here.z, 2.0 * far)
    return Surroundings(solids, has_nearby_solids(solids), has_bodies)


@kernel
def sweep(world: World, bodies: Bodies, surroundings: Surroundings, at: Point, delta: Point) -> Contact:
    """Return the first contact with a solid or another body."""
    contact = FREE
    if surroundings.has_solids:
        contact = sweep_nearby_solids(world, surroundings.solids, at.x, at.y, at.z, delta.x, delta.y, delta.z)
    if surroundings.has_bodies:
        position, others, mover = bodies
        other = sweep_bodies(position, others, mover, at.x, at.y, at.z, delta.x, delta.y, delta.z)
        if other.fraction < contact.fraction:
            contact = other
    return contact


@kernel
def along(at: Point, delta: Point, fraction: float) -> Point:
    """Return the place after a fraction of a displacement."""
    return Point(at.x + delta.x * fraction, at.y + delta.y * fraction, at.z + delta.z * fraction)


@kernel
def slide(world: World, bodies: Bodies, surroundings: Surroundings, at: Point, delta: Point) -> Point:
    """Move by a displacement, sliding along the surfaces that stop the body; return where it ends.

    A body slides up floors and gentle roofs, only sideways along walls and steep faces, and never over the
    edge of the map.
    """
    first_x, first_z = delta.x, delta.z
    for _ in range(SLIDES):
        delta = inside_edges(world, at, delta)
        contact = sweep(world, bodies, surroundings, at, delta)
        at = along(at, delta, contact.fraction)
        if contact.fraction >= 1.0:
            break
        left = 1.0 - contact.fraction
        delta = clip(sideways(contact), Point(delta.x * left, delta.y * left, delta.z * left))
        # Never turn back: the body would jitter in a corner.
        if delta.x * first_x + delta.z * first_z <= 0.0:
            break
    return at


@kernel
def sideways(contact: Contact) -> Contact:
    """Return a contact; one with a face too steep to walk up becomes a contact with a wall."""
    if not 0.0 < contact.n_y < COS_SLOPE_LIMIT:
        return contact
    flat = np.sqrt(contact.n_x * contact.n_x + contact.n_z * contact.n_z)
    return Contact(contact.fraction, contact.n_x / flat, 0.0, contact.n_z / flat)


@kernel
def clip(contact: Contact, delta: Point) -> Point:
    """Return the part of a displacement along the surface that stopped it."""
    into = (delta.x * contact.n_x + delta.y * contact.n_y + delta.z * contact.n_z) * SEPARATION
    return Point(delta.x - contact.n_x * into, delta.y - contact.n_y * into, delta.z - contact.n_z * into)


@kernel
def inside_edges(world: World, here: Point, delta: Point) -> Point:
    """Limit a displacement so that it ends inside the map or, from outside, leads no farther out."""
    rows, columns = world.water.shape
    west, south = world.corner[0] + EDGE_MARGIN, world.corner[1] + EDGE_MARGIN
    east = world.corner[0] + columns * CELL - EDGE_MARGIN
    north = world.corner[1] + rows * CELL - EDGE_MARGIN
    delta_x = max(min(delta.x, max(east - here.x, 0.0)), min(west - here.x, 0.0))
    delta_z = max(min(delta.z, max(north - here.z, 0.0)), min(south - here.z, 0.0))
    return Point(delta_x, delta.y, delta_z)
