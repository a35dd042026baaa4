"""Laying out a map: the ground and everything that stands on it."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from wildscav_engine.geometry.world import CELL, Solid
from wildscav_engine.maps.base import Base, load_base
from wildscav_engine.maps.country import CountryPlan, barriers_of, plan_country, shape_country
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.ground.terrain import Terrain, level_ground, make_terrain
from wildscav_engine.maps.house import HousePlan, build_house, doorsteps, draw_house, house_of
from wildscav_engine.maps.placements import fixed_houses, placed_solids
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.settlements.sites import Settlement, Site, footprints_of, room_for, settle
from wildscav_engine.maps.vegetation.planting import plant
from wildscav_engine.specs.map_spec import MapConfig

NO_HOUSE = -1
NOTHING = np.zeros((0, 2))
DOORSTEP = 1.5  # m in front of an outer doorway


class Layout(NamedTuple):
    """A map before it is indexed and explored."""

    terrain: Terrain
    solids: list[Solid]
    solid_house: list[int]  # the house that each solid belongs to, NO_HOUSE for none
    houses: tuple[House, ...]
    sites: tuple[Site, ...]  # of the houses
    country: CountryPlan | None


def lay_out(config: MapConfig, seed: int, avoided: Sequence[Site] = ()) -> Layout:
    """Lay out a map: ground, placed and random houses, then plants and rocks.

    Raises:
        MapError: The config asks for something impossible; the message names the field.
    """
    base = load_base(config.base) if config.base else None
    terrain = _ground(config, seed, base)
    country = plan_country(config, seed, terrain)
    plans, settlement = settle_houses(config, seed, terrain, avoided, country)
    sites = settlement.sites
    level_sites = sites + [town.site for town in country.towns] if country else sites
    levels = np.array([site.ground for site in level_sites], np.float64)
    level_ground(terrain.corner, footprints_of(level_sites), levels, terrain.heights)
    if country:
        sites = shape_country(country, seed, terrain, sites)
    solids, solid_house = _build(plans, sites)
    steps = [
        step for plan, site in zip(plans, sites, strict=True) for step in doorsteps(plan, site, DOORSTEP)
    ]
    free = np.array(steps, np.float64).reshape(-1, 2)
    if country:
        free = np.concatenate([free, country.gates])
    taken = country.taken if country else None
    plants = plant(config, seed, terrain, sites, free, settlement.lanes, taken)
    if base:
        plants = _clear_of(base.solids, plants)
        solids += base.solids
    if country:
        solids += barriers_of(country, seed, terrain)
    solids += placed_solids(config, seed, terrain) + plants
    solid_house += [NO_HOUSE] * (len(solids) - len(solid_house))
    houses = tuple(house_of(plan, site) for plan, site in zip(plans, sites, strict=True))
    return Layout(terrain, solids, solid_house, houses, tuple(sites), country)


def _ground(config: MapConfig, seed: int, base: Base | None) -> Terrain:
    if base is None:
        return make_terrain(config, seed)
    if base.size != config.size:
        raise MapError(f"size is {config.size}, but the base {base.name!r} is {base.size} m; it must be that")
    if base.solids and config.houses:
        raise MapError(
            f"houses is {config.houses}: on a base with solids, like {base.name!r}, houses stand only where "
            "placements put them; houses must be 0"
        )
    points = int(config.size // CELL) + 1
    heights = np.zeros((points, points)) if base.heights is None else base.heights.copy()
    return Terrain((-config.size / 2.0, -config.size / 2.0), heights, base.water_level)


def settle_houses(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    avoided: Sequence[Site] = (),
    country: CountryPlan | None = None,
) -> tuple[list[HousePlan], Settlement]:
    """Draw the houses and find their sites, placed ones first; if they do not fit, draw smaller ones.

    Args:
        terrain: Before any ground is levelled.
        country: Whose towns are settled after the placed houses, and whose borders houses keep off.

    Returns:
        The plan of each house, and all sites.

    Raises:
        MapError: Not all houses fit on the map, or a placed one does not fit at its location.
    """
    fixed_plans, fixed_sites = fixed_houses(config, seed, terrain)
    kept_off = NOTHING
    if country:
        fixed_plans, fixed_sites = fixed_plans + country.plans, fixed_sites + country.sites
        avoided, kept_off = [*avoided, *(town.site for town in country.towns)], country.kept_off
    settled = partial(settle, config, seed, terrain, fixed=fixed_sites, avoided=avoided, kept_off=kept_off)
    for small in (False, True):
        plans = [
            draw_house(config.pieces, seed, number, config.storeys, small=small)
            for number in range(config.houses)
        ]
        sizes = [plan.size for plan in plans]
        found = settled(sizes)
        if len(found.sites) == len(plans):
            return fixed_plans + plans, Settlement(fixed_sites + found.sites, found.lanes)
    most = room_for(settled, sizes)
    raise MapError(
        f"houses is {config.houses}: a map of {config.size} m with seed {seed}, relief {config.relief} and "
        f"water {config.water} has room for 0 to {most}"
    )


def _build(plans: Sequence[HousePlan], sites: Sequence[Site]) -> tuple[list[Solid], list[int]]:
    """Return the solids of all houses, and the number of each solid's house."""
    solids: list[Solid] = []
    solid_house: list[int] = []
    for number, (plan, site) in enumerate(zip(plans, sites, strict=True)):
        built = build_house(plan, site)
        solids += built
        solid_house += [number] * len(built)
    return solids, solid_house


def _clear_of(parts: Sequence[Solid], plants: list[Solid]) -> list[Solid]:
    """Return the plants that stand clear of imported parts."""
    if not parts or not plants:
        return plants
    low, high = np.array([solid.low for solid in parts]), np.array([solid.high for solid in parts])
    apart = [((low > solid.high) | (high < solid.low))[:, [0, 2]].any(axis=1).all() for solid in plants]
    return [solid for solid, is_apart in zip(plants, apart, strict=True) if is_apart]
