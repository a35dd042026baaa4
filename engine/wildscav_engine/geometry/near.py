"""The solids near a body, found once for all sweeps of one move.

Around houses a cell holds dozens of solids, of which a body can touch a few in one move. These are marked as
bits: a number for each of the four cells that a body reaches into, a bit for each solid listed there.
"""

from typing import NamedTuple

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import FREE, Contact, box_of_sweep, is_apart, sweep_solid, sweep_world
from wildscav_engine.geometry.world import World, cell_of

BITS = 62  # solids of a cell that have a bit; where there are more, all are swept
BYTE = 255


class Near(NamedTuple):
    """Which solids a body can touch: in up to 2 × 2 cells, bit i stands for a cell's i-th solid."""

    row: int  # of the south-western cell
    column: int
    south_west: int
    south_east: int
    north_west: int
    north_east: int
    is_crowded: bool  # whether a cell has more solids than bits


@kernel
def solids_near(world: World, x: float, z: float, reach: float, low: float, high: float) -> Near:
    """Find all solids whose boxes come near a body.

    Args:
        world: The static world.
        x: m, the middle of the body.
        z: m.
        reach: m to all sides, less than half a cell.
        low: m, the lowest height looked at.
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
                    break  # so is all that follows
                if (
                    world.solid_high[solid, 1] < low
                    or world.solid_low[solid, 0] > x + reach
                    or world.solid_high[solid, 0] < x - reach
                    or world.solid_low[solid, 2] > z + reach
                    or world.solid_high[solid, 2] < z - reach
                ):
                    continue
                # What is also in a cell before this one has its bit there.
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
    return Near(south, west, south_west, south_east, north_west, north_east, is_crowded)


@kernel
def is_anything_near(near: Near) -> bool:
    """Return whether there is any solid."""
    return (near.south_west | near.south_east | near.north_west | near.north_east) != 0


@kernel
def sweep_near(
    world: World, near: Near, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Contact:
    """Return how far a body can go before it touches one of the solids near it; see ``sweep_world``."""
    if near.is_crowded:
        return sweep_world(world, x, y, z, dx, dy, dz)
    columns = world.water.shape[1]
    first = FREE
    swept = box_of_sweep(x, y, z, dx, dy, dz)
    for part in range(4):
        bits = near.south_west
        if part == 1:
            bits = near.south_east
        elif part == 2:
            bits = near.north_west
        elif part == 3:
            bits = near.north_east
        if bits == 0:
            continue
        item = world.cell_start[(near.row + part // 2) * columns + near.column + part % 2]
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
