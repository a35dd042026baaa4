"""Planning the country of a map: its wards and towns, what keeps clear of them, and all barriers."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Solid
from wildscav_engine.maps.country.ridges import raise_ridges
from wildscav_engine.maps.country.terraces import raise_terraces, ward_of_points
from wildscav_engine.maps.country.thickets import grow_thickets
from wildscav_engine.maps.country.towns import Town, choose_blocks, draw_town
from wildscav_engine.maps.country.walls import build_walls
from wildscav_engine.maps.country.wards import Barrier, Wards, draw_wards
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.house import HousePlan
from wildscav_engine.maps.settlements.footprints import Site
from wildscav_engine.specs.map_spec import Country, MapConfig

KEPT_OFF = 3.0  # m beside a border, the lines that houses keep off
POINT_STEP = 2.0  # m between the points of these lines
# m on either side of a border where nothing else grows
CLEAR = {
    Barrier.WALL: 1.5,
    Barrier.THICKET: 2.6,
    Barrier.RIDGE: 2.6,
    Barrier.CLIFF: 1.5,
    Barrier.TOWN_WALL: 1.5,
}


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
    """Draw the country of a map; None if its config has none.

    Args:
        terrain: Before any ground is levelled.
    """
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
    """Raise the ground, in place, to its terraces and ridges; return the sites of houses raised with it.

    Args:
        terrain: With levelled ground.
        sites: Of all houses; each stands in one ward.
    """
    raised = list(sites)
    if plan.wards.levels.any():
        wards = ward_of_points(plan.wards, terrain)
        for number, site in enumerate(raised):
            row, column = (
                int((at - corner) / CELL + 0.5)
                for at, corner in zip((site.pose.z, site.pose.x), terrain.corner[::-1], strict=True)
            )
            lift = float(plan.wards.levels[wards[row, column]])
            raised[number] = site._replace(ground=site.ground + lift)
    raise_terraces(plan.wards, terrain)
    raise_ridges(plan.wards, seed, terrain)
    return raised


def barriers_of(plan: CountryPlan, seed: int, terrain: Terrain) -> list[Solid]:
    """Return the solids of all barriers, on the finished ground."""
    across_streets = [wall for town in plan.towns for wall in town.walls]
    borders = plan.wards.borders
    return build_walls(borders, terrain) + grow_thickets(borders, seed, terrain) + across_streets
