"""Walls: of gardens and yards with gates, and of towns; too high to jump."""

from collections.abc import Sequence

from wildscav_engine.geometry.shapes import Pose, box
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.country.wards import Barrier, Border
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.streets import height_at

HEIGHTS = {Barrier.WALL: 2.5, Barrier.TOWN_WALL: 4.0}  # m above the highest ground at its foot
THICKNESS = {Barrier.WALL: 0.4, Barrier.TOWN_WALL: 0.7}  # m
GATE_WIDTH = 2.8  # m
LONGEST = 4.0  # m, of the pieces of a wall; each is level on top
OVERLAP = 0.12  # m that pieces reach into each other
ROOT = 0.6  # m that a wall reaches into the lowest ground
POST, POST_RISE = 0.8, 0.5  # m, the side of the posts of a gate, and their height above the wall


def build_walls(borders: Sequence[Border], terrain: Terrain) -> list[Solid]:
    """Return the walls on those borders that have one, with posts at their gates."""
    solids = []
    for border in borders:
        if border.barrier not in HEIGHTS:
            continue
        height, thickness = HEIGHTS[border.barrier], THICKNESS[border.barrier]
        for start, end in border.spans(GATE_WIDTH):
            pieces = max(1, int((end - start) / LONGEST + 0.999))
            step = (end - start) / pieces
            for piece in range(pieces):
                first = start + piece * step
                solids.append(_piece(border, first, first + step, thickness, height, terrain))
        if border.gate is not None:
            reach = (GATE_WIDTH + POST) / 2.0
            for middle in (border.gate - reach, border.gate + reach):
                ends = middle - POST / 2.0 + OVERLAP, middle + POST / 2.0 - OVERLAP
                solids.append(_piece(border, *ends, POST, height + POST_RISE, terrain))
    return solids


def _piece(
    border: Border, start: float, end: float, thickness: float, height: float, terrain: Terrain
) -> Solid:
    """Return a box along a border, from ``start`` to ``end`` m, as high as the ground under it demands."""
    grounds = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        for aside in (-thickness, 0.0, thickness):
            x, z = border.at(start + share * (end - start), aside)
            grounds.append(height_at(terrain.corner, terrain.heights, x, z))
    x, z = border.at((start + end) / 2.0)
    half = (end - start) / 2.0 + OVERLAP
    low, high = min(grounds) - ROOT, max(grounds) + height
    where = Pose(x, z, *border.direction)
    return box(Kind.WALL, where, (-thickness / 2.0, low, -half), (thickness / 2.0, high, half))
