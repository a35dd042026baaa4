"""From a config and a seed to a map: terrain, houses, vegetation, and the places that can be reached."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Solid, World, build_world
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.house import HousePlan, build_house, doorsteps, draw_plan, house_of
from wildscav_engine.maps.locations import NODE, indoor_places, outdoor_places, reachable_ground
from wildscav_engine.maps.sites import Site, footprints_of, place_houses
from wildscav_engine.maps.terrain import Terrain, level_ground, make_terrain, water_of_cells
from wildscav_engine.maps.vegetation import plant
from wildscav_engine.spec import MapConfig, MapSpec

NO_HOUSE = -1
DOORSTEP = 1.5  # m before an outer doorway, where one stands before going in


def generate_map(config: MapConfig, seed: int) -> GameMap:
    """Make a map. The same config and seed give the same bytes on any machine.

    Args:
        config: What kind of map.
        seed: Which of them, 0 to 2⁶⁴ - 1.

    Returns:
        The map.

    Raises:
        MapError: The config asks for more than this map has room for, or leaves no place to stand.
    """
    spec = MapSpec(config=config, seed=seed)
    terrain = make_terrain(config, seed)
    plans, sites = _settle(config, seed, terrain)
    footprints = footprints_of(sites)
    level_ground(
        terrain.corner, footprints, np.array([site.ground for site in sites], np.float64), terrain.heights
    )
    solids, solid_house = _build_houses(plans, sites)
    steps = [
        step for plan, site in zip(plans, sites, strict=True) for step in doorsteps(plan, site, DOORSTEP)
    ]
    solids += plant(config, seed, terrain, footprints, np.array(steps, np.float64).reshape(-1, 2))
    solid_house += [NO_HOUSE] * (len(solids) - len(solid_house))
    water = water_of_cells(terrain.heights, terrain.water_level)
    world = build_world(terrain.corner, terrain.heights, water, solids, np.zeros((0, 3)))
    outdoor, indoor = _places(world, spec, plans, sites)
    return GameMap(
        spec=spec,
        world=world._replace(spawns=outdoor),
        houses=tuple(house_of(plan, site) for plan, site in zip(plans, sites, strict=True)),
        indoor=indoor,
        outdoor=outdoor,
        solid_house=np.array(solid_house, np.int16),
    )


def plans_and_sites(config: MapConfig, seed: int) -> tuple[list[HousePlan], list[Site]]:
    """Return what the houses of a map are like inside, and where they stand."""
    return _settle(config, seed, make_terrain(config, seed))


def _settle(config: MapConfig, seed: int, terrain: Terrain) -> tuple[list[HousePlan], list[Site]]:
    """Draw the houses and find their places; where they have no room, draw smaller ones."""
    for small in (False, True):
        plans = [draw_plan(seed, number, config.storeys, small=small) for number in range(config.houses)]
        sites = place_houses(config, seed, terrain, [plan.size for plan in plans])
        if len(sites) == len(plans):
            break
    else:
        raise MapError(
            f"houses is {config.houses}: a map of {config.size} m with seed {seed} and water {config.water} "
            f"has room for 0 to {len(sites)}"
        )
    return plans, sites


def _build_houses(plans: list[HousePlan], sites: list[Site]) -> tuple[list[Solid], list[int]]:
    solids: list[Solid] = []
    solid_house: list[int] = []
    for number, (plan, site) in enumerate(zip(plans, sites, strict=True)):
        built = build_house(plan, site)
        solids += built
        solid_house += [number] * len(built)
    return solids, solid_house


def _places(
    world: World, spec: MapSpec, plans: list[HousePlan], sites: list[Site]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return outdoor and indoor places, each (N, 3) m."""
    reachable = reachable_ground(world)
    outdoor = outdoor_places(world, reachable, np.uint64(spec.seed))
    if len(outdoor) == 0:
        raise MapError(
            f"seed {spec.seed} leaves no open ground to stand on in a map of {spec.config.size} m "
            f"with water {spec.config.water} and vegetation {spec.config.vegetation}"
        )
    indoor: list[tuple[float, float, float]] = []
    for number, (plan, site) in enumerate(zip(plans, sites, strict=True)):
        if any(_is_reachable(world, reachable, step) for step in doorsteps(plan, site, DOORSTEP)):
            indoor += indoor_places(world, spec.seed, number, plan, site)
    return outdoor, np.array(indoor, np.float64).reshape(-1, 3)


def _is_reachable(world: World, reachable: NDArray[np.bool_], place: tuple[float, float]) -> bool:
    """Return whether the ground's node nearest to a place can be reached."""
    column = int((place[0] - world.corner[0]) / NODE + 0.5)
    row = int((place[1] - world.corner[1]) / NODE + 0.5)
    rows, columns = reachable.shape
    return 0 <= row < rows and 0 <= column < columns and bool(reachable[row, column])
