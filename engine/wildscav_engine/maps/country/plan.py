"""Planning the country of a map: its wards and towns, what keeps clear of them, and all barriers.

Barriers are too high to jump. Walls are those of gardens and yards, with gates, and of towns. Thickets are
hedges with trees in them, too dense to walk through, with gaps.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.shapes import Pose, box, polygon, stack
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.country.landforms import raise_ridges, raise_terraces, wards_at
from wildscav_engine.maps.country.towns import Town, choose_blocks, draw_town
from wildscav_engine.maps.country.wards import Barrier, Border, Wards, draw_wards
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.house import HousePlan
from wildscav_engine.maps.settlements.footprints import Site
from wildscav_engine.maps.settlements.streets import height_at
from wildscav_engine.specs.map_spec import Country, MapConfig

KEPT_OFF = 3.0  # m beside a border, the lines that houses keep off
POINT_STEP = 2.0  # m between the points of these lines
# m on either side of a border where nothing else grows
CLEAR = dict.fromkeys(Barrier, 1.5) | {Barrier.THICKET: 2.6, Barrier.RIDGE: 2.6}
HEIGHTS = {Barrier.WALL: 2.5, Barrier.TOWN_WALL: 4.0}  # m above the highest ground at its foot
THICKNESS = {Barrier.WALL: 0.4, Barrier.TOWN_WALL: 0.7}  # m
GATE_WIDTH = 2.8  # m
LONGEST = 4.0  # m, of the pieces of a wall; each is level on top
OVERLAP = 0.12  # m that pieces reach into each other
ROOT = 0.6  # m that a wall reaches into the lowest ground
POST, POST_RISE = 0.8, 0.5  # m, the side of the posts of a gate, and their height above the wall
GAP = 3.4  # m between the axes of the outermost bushes of a gap, less their radii
STEP = 1.25  # m from one bush to the next: they overlap by far
RADIUS = (1.0, 1.35)  # m, of bushes
HEIGHT = (2.3, 3.3)  # m above the highest ground under a bush
WAVER = 0.3  # m that bushes stand off the border
TREES = 0.3  # of the bushes have a tree in them
BUSH_ROOT = 0.5  # m


class CountryPlan(NamedTuple):
    """The country of a map, before the map is built."""

    country: Country
    wards: Wards
    towns: tuple[Town, ...]

    @property
    def plans(self) -> list[HousePlan]:
        """The plans of all houses in towns."""
        return [plan for town in self.towns for plan in town.plans]

    @property
    def sites(self) -> list[Site]:
        """The sites of all houses in towns."""
        return [site for town in self.towns for site in town.sites]

    @property
    def kept_off(self) -> NDArray[np.float64]:
        """(N, 2) m, points that houses keep off: the borders and lines beside them."""
        points = []
        for border in self.wards.borders:
            steps = max(1, int(border.length / POINT_STEP))
            for step in range(steps + 1):
                along = border.length * step / steps
                points += [border.at(along, aside) for aside in (-KEPT_OFF, 0.0, KEPT_OFF)]
        return np.array(points, np.float64).reshape(-1, 2)

    @property
    def taken(self) -> NDArray[np.float64]:
        """(F, 6) footprints where nothing else grows: the borders and the towns."""
        rows = []
        for border in self.wards.borders:
            middle = border.at(border.length / 2.0)
            rows.append((*middle, *border.direction, CLEAR[border.barrier], border.length / 2.0))
        rows += [town.site.footprint for town in self.towns]
        return np.array(rows, np.float64).reshape(-1, 6)

    @property
    def gates(self) -> NDArray[np.float64]:
        """(G, 2) m, the middles of all ways through borders."""
        found = [border.at(border.gate) for border in self.wards.borders if border.gate is not None]
        return np.array(found, np.float64).reshape(-1, 2)


def plan_country(config: MapConfig, seed: int, terrain: Terrain) -> CountryPlan | None:
    """Draw the country of a map, whose ground is not levelled yet; None if its config has none."""
    if config.country is None:
        return None
    blocks = choose_blocks(config.size, config.country, seed, terrain)
    wards = draw_wards(config.size, config.country, seed, blocks)
    towns = []
    for number, block in enumerate(blocks):
        ward = int(wards.numbers[block.row, block.column])
        gates = [
            border.at(border.gate)
            for border in wards.borders
            if border.gate is not None and ward in border.wards
        ]
        towns.append(draw_town(config, config.country, seed, number, block, gates, terrain))
    return CountryPlan(config.country, wards, tuple(towns))


def shape_country(plan: CountryPlan, seed: int, terrain: Terrain, sites: Sequence[Site]) -> list[Site]:
    """Raise the levelled ground, in place, to its terraces and ridges; return the sites raised with it."""
    raised = list(sites)
    if plan.wards.levels.any():
        x, z = np.array([(site.pose.x, site.pose.z) for site in sites], np.float64).reshape(-1, 2).T
        lifts = plan.wards.levels[wards_at(plan.wards, terrain, x, z)].tolist()
        raised = [site._replace(ground=site.ground + lift) for site, lift in zip(sites, lifts, strict=True)]
    raise_terraces(plan.wards, terrain)
    raise_ridges(plan.wards, seed, terrain)
    return raised


def barriers_of(plan: CountryPlan, seed: int, terrain: Terrain) -> list[Solid]:
    """Return the solids of all barriers, on the finished ground."""
    across_streets = [wall for town in plan.towns for wall in town.walls]
    borders = plan.wards.borders
    return build_walls(borders, terrain) + grow_thickets(borders, seed, terrain) + across_streets


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
            grounds.append(height_at(terrain, x, z))
    x, z = border.at((start + end) / 2.0)
    half = (end - start) / 2.0 + OVERLAP
    low, high = min(grounds) - ROOT, max(grounds) + height
    where = Pose(x, z, *border.direction)
    return box(Kind.WALL, where, (-thickness / 2.0, low, -half), (thickness / 2.0, high, half))


def grow_thickets(borders: Sequence[Border], seed: int, terrain: Terrain) -> list[Solid]:
    """Return the bushes and trees on those borders that are thickets."""
    solids = []
    for number, border in enumerate(borders):
        if border.barrier is not Barrier.THICKET:
            continue
        dice = RandomStream(seed, Stream.COUNTRY, agent=20_000 + number)
        for start, end in border.spans(GAP + 2.0 * RADIUS[0]):
            steps = max(1, int((end - start) / STEP + 0.999))
            for step in range(steps + 1):
                along = start + (end - start) * step / steps
                x, z = border.at(along, dice.uniform(-WAVER, WAVER))
                # Bushes at a gap are of the least size, so that all gaps are passable.
                is_last = border.gate is not None and abs(along - border.gate) < GAP / 2.0 + 3.0
                solids += _bush(dice, x, z, terrain, narrow=is_last)
    return solids


def _bush(dice: RandomStream, x: float, z: float, terrain: Terrain, *, narrow: bool) -> list[Solid]:
    """Return a bush, perhaps with a conifer that rises from it."""
    radius = RADIUS[0] if narrow else dice.uniform(*RADIUS)
    grounds = [
        height_at(terrain, x + east, z + north)
        for east, north in ((0.0, 0.0), (radius, 0.0), (-radius, 0.0), (0.0, radius), (0.0, -radius))
    ]
    low, top = min(grounds) - BUSH_ROOT, max(grounds) + dice.uniform(*HEIGHT)
    outline = polygon(7, dice.uniform(0.0, 360.0))
    middle = 0.5 * (max(grounds) + top)
    rings = ((low, radius * 0.9), (middle, radius), (top - 0.3, radius * 0.8), (top, radius * 0.55))
    solids = [stack(Kind.BUSH, x, z, outline, rings)]
    if dice.uniform() < TREES:
        crown, rise = dice.uniform(1.2, 1.9), dice.uniform(4.0, 7.5)
        solids.append(stack(Kind.TRUNK, x, z, polygon(6, 0.0), ((low, 0.3), (top + 0.6, 0.25))))
        cone = ((top + 0.4, crown * 0.5), (top + 1.2, crown), (top + rise, 0.0))
        solids.append(stack(Kind.CROWN, x, z, outline, cone))
    return solids
