"""The solids near a body, found once and used by all sweeps of one move.

Near houses a cell lists dozens of solids, but a body can touch only a few of them in one move. These few are
kept as bit masks: one for each of the up to four cells that the body reaches into, with one bit for each
solid that the cell lists.
"""

from typing import NamedTuple

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import FREE, Contact, box_of_sweep, is_apart, sweep_solid, sweep_world
from wildscav_engine.geometry.world import World, cell_of

BITS = 62  # solids of a cell that can have a bit; with more, every solid is swept
BYTE = 255


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
